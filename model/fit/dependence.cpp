// Cosines over the travel and levels of conditions as columns; the share by least squares on them.
#include "model/fit/dependence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "laser/csv_columns.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Readings of a sense below which a variable is not cut into levels: two levels of two.
constexpr std::size_t kFewestOfSense = 4;
/// Values closer than this share of their range are one level.
constexpr double kSameLevel = 1e-6;
/// Places [mm] of a parked axis closer than this are one: ten times what makes two targets.
constexpr double kSameParked_mm = 10.0 * kSamePlace_mm;
/// Levels of a position (a full line of targets), and of a condition: a choice; more levels are more freedom to fit.
constexpr std::size_t kMostLevels = 40, kMostConditionLevels = 8;
/// Half waves over the travel: of the difference of approaches, of a run, of what compensation does. A choice: shapes
/// shorter than an eighth of the travel are left to the levels of the position.
constexpr std::size_t kWavesOfApproach = 8, kWavesOfRun = 4, kWavesOfMap = 6;
/// Runs beyond which a run is no variable, and beyond which its shape over the travel is not looked at: a choice, each
/// run costs two to six functions.
constexpr std::size_t kMostRuns = 60, kMostRunsWithShape = 12;
/// Half waves in time: nothing faster than four minutes, which turbulence may do (up to about a minute is noise); two
/// at least, twelve at most.
constexpr double kFastest_s = 240.0, kFewestWavesOfTime = 2.0, kMostWavesOfTime = 12.0;

/// Functions collected one by one.
class Functions {
 public:
  explicit Functions(std::size_t n) : n_(n) {}
  template <class F>
  void add(const F& f) {
    VectorXd column(static_cast<Index>(n_));
    for (std::size_t k = 0; k < n_; ++k) {
      const double value = f(k);
      column(static_cast<Index>(k)) = std::isnan(value) ? 0.0 : value;
    }
    columns_.push_back(std::move(column));
  }
  [[nodiscard]] MatrixXd matrix() const {
    MatrixXd m(static_cast<Index>(n_), static_cast<Index>(columns_.size()));
    for (std::size_t j = 0; j < columns_.size(); ++j) m.col(static_cast<Index>(j)) = columns_[j];
    return m;
  }
  [[nodiscard]] bool empty() const { return columns_.empty(); }

 private:
  std::size_t n_;
  std::vector<VectorXd> columns_;
};

std::vector<Channel> channels_of(const Observations& data) {
  std::set<Channel> channels;
  for (std::size_t k = 0; k < data.size(); ++k) channels.insert(data.channel(k));
  return {channels.begin(), channels.end()};
}

/// Functions of one column of numbers within one sense: one per value if there are few, else `most` equal shares.
template <class Value, class Weight>
void add_levels(Functions& functions, const Observations& data, Channel channel, const Value& value, std::size_t most,
                const Weight& weight) {
  std::vector<double> values;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.channel(k) == channel && !std::isnan(value(k))) values.push_back(value(k));
  if (values.size() < kFewestOfSense) return;
  std::ranges::sort(values);
  const double width = values.back() - values.front();
  if (width <= 0.0) return;
  std::vector<double> levels = distinct(values, kSameLevel * width);
  std::vector<double> ends;  // upper ends of all bins but the last
  if (levels.size() <= most) {
    for (std::size_t i = 0; i + 1 < levels.size(); ++i) ends.push_back(0.5 * (levels[i] + levels[i + 1]));
  } else {
    for (std::size_t i = 1; i < most; ++i) ends.push_back(values[i * values.size() / most]);
    ends = distinct(ends, 0.0);
  }
  double before = -kBeyondAll;
  ends.push_back(kBeyondAll);
  for (const double end : ends) {
    functions.add([&](std::size_t k) {
      const bool inside = data.channel(k) == channel && value(k) > before && value(k) <= end;
      return inside ? weight(k) : 0.0;
    });
    before = end;
  }
}

const auto kOne = [](std::size_t) { return 1.0; };

double cell(const Column& column, std::size_t k) { return column.empty() ? kNotMeasured : column[k]; }

/// Centred coordinate of the moving axis, about −1 … 1.
std::vector<double> scaled_positions(const Observations& data) {
  std::vector<double> scaled(data.size());
  for (const Channel channel : channels_of(data))
    for (const Axis a : kAllAxes) {
      double least = kBeyondAll, greatest = -kBeyondAll;
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.channel(k) == channel && data.axis[k] == a) {
          least = std::min(least, data.along_of(k));
          greatest = std::max(greatest, data.along_of(k));
        }
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.channel(k) == channel && data.axis[k] == a && greatest > least)
          scaled[k] = 2.0 * (data.along_of(k) - least) / (greatest - least) - 1.0;
    }
  return scaled;
}

/// Curves along the moving axis that differ with where another axis is parked.
void add_curves_by_parking(const Observations& data, Axis parked, Channel channel, const std::vector<double>& scaled,
                           Functions& functions) {
  constexpr std::size_t kMostPlaces = 12, kWaves = 4;
  if (channel >= kSenseChannels) return;
  for (const Axis moving : kAllAxes) {
    if (moving == parked) continue;
    const auto mine = [&](std::size_t k) { return data.channel(k) == channel && data.axis[k] == moving; };
    std::vector<double> places;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (mine(k)) places.push_back(data.p_mm(k, parked));
    places = distinct(std::move(places), kSamePlace_mm);
    if (places.size() < 2 || places.size() > kMostPlaces) continue;
    for (const double place : places)
      for (std::size_t m = 1; m <= kWaves; ++m)
        functions.add([&](std::size_t k) {
          return mine(k) && std::abs(data.p_mm(k, parked) - place) < kSameParked_mm
                     ? std::cos(0.5 * static_cast<double>(m) * std::numbers::pi * (scaled[k] + 1.0))
                     : 0.0;
        });
  }
}

void add_positions(const Observations& data, const std::vector<double>& scaled, std::vector<Variable>& out) {
  for (const Axis a : kAllAxes) {
    Functions functions(data.size());
    for (const Channel channel : channels_of(data)) {
      add_levels(
          functions, data, channel, [&](std::size_t k) { return data.p_mm(k, a); }, kMostLevels, kOne);
      add_curves_by_parking(data, a, channel, scaled, functions);
    }
    if (!functions.empty()) out.push_back({std::string(data.position_name(a)), functions.matrix()});
  }
}

/// The place along paths: angle on circles, distance on lines.
void add_places_along(const Observations& data, std::vector<Variable>& out) {
  for (const PathKind kind : {PathKind::circle, PathKind::line}) {
    Functions functions(data.size());
    std::string name;
    for (std::size_t path = 0; path < data.paths.size(); ++path) {
      if (data.paths[path].kind != kind) continue;
      name = variable_along(data.paths[path]);
      add_levels(
          functions, data, kSenseChannels + static_cast<Channel>(path), [&](std::size_t k) { return data.along[k]; },
          kMostLevels, kOne);
    }
    if (!functions.empty()) out.push_back({name, functions.matrix()});
  }
}

/// Difference of both directions of circles: harmonics of the angle.
void add_directions_of_circles(const Observations& data, Functions& functions) {
  for (std::size_t path = 0; path < data.paths.size(); ++path) {
    if (data.paths[path].kind != PathKind::circle) continue;
    const auto d = [&](std::size_t k) {
      return data.on_path(k) && data.path[k] == path + 1 ? static_cast<double>(data.approach[k]) : 0.0;
    };
    bool forward = false, reverse = false;
    for (std::size_t k = 0; k < data.size(); ++k) {
      forward = forward || d(k) > 0.0;
      reverse = reverse || d(k) < 0.0;
    }
    if (!forward || !reverse) continue;
    for (std::size_t m = 1; m <= kWavesOfApproach; ++m) {
      const auto angle = [&](std::size_t k) {
        return static_cast<double>(m) * data.along[k] * std::numbers::pi / 180.0;
      };
      functions.add([&](std::size_t k) { return d(k) == 0.0 ? 0.0 : d(k) * std::cos(angle(k)); });
      functions.add([&](std::size_t k) { return d(k) == 0.0 ? 0.0 : d(k) * std::sin(angle(k)); });
    }
  }
}

void add_approach(const Observations& data, const std::vector<double>& scaled, std::vector<Variable>& out) {
  Functions functions(data.size());
  for (const Channel channel : channels_of(data))
    for (const Axis a : kAllAxes) {
      bool forward = false, reverse = false;
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.channel(k) == channel && data.axis[k] == a) {
          forward = forward || data.approach[k] > 0;
          reverse = reverse || data.approach[k] < 0;
        }
      if (!forward || !reverse) continue;
      const auto d = [&](std::size_t k) {
        return data.channel(k) == channel && data.axis[k] == a ? static_cast<double>(data.approach[k]) : 0.0;
      };
      functions.add(d);
      for (std::size_t m = 1; m <= kWavesOfApproach; ++m)
        functions.add([&](std::size_t k) {
          return d(k) * std::cos(0.5 * static_cast<double>(m) * std::numbers::pi * (scaled[k] + 1.0));
        });
    }
  add_directions_of_circles(data, functions);
  if (!functions.empty()) out.push_back({"approach", functions.matrix()});
}

/// Products of two coordinates that vary in readings of one sense: a twist.
void add_products(const Observations& data, std::vector<Variable>& out) {
  struct Pair {
    Axis a, b;
  };
  for (const Pair& pair : {Pair{Axis::X, Axis::Y}, Pair{Axis::X, Axis::Z}, Pair{Axis::Y, Axis::Z}}) {
    Functions functions(data.size());
    for (const Channel channel : channels_of(data)) {
      std::vector<double> a, b;
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.channel(k) == channel) {
          a.push_back(data.p_mm(k, pair.a));
          b.push_back(data.p_mm(k, pair.b));
        }
      const auto in_a = std::ranges::minmax_element(a), in_b = std::ranges::minmax_element(b);
      const double from_a = *in_a.min, to_a = *in_a.max, from_b = *in_b.min, to_b = *in_b.max;
      if (to_a - from_a <= kSamePlace_mm || to_b - from_b <= kSamePlace_mm) continue;
      functions.add([&](std::size_t k) {
        if (data.channel(k) != channel) return 0.0;
        return (data.p_mm(k, pair.a) - 0.5 * (from_a + to_a)) * (data.p_mm(k, pair.b) - 0.5 * (from_b + to_b)) /
               ((to_a - from_a) * (to_b - from_b));
      });
    }
    if (!functions.empty())
      out.push_back({fmt::format("{}*{}", data.position_name(pair.a), data.position_name(pair.b)), functions.matrix()});
  }
}

void add_runs(const Observations& data, const std::vector<double>& scaled, std::vector<Variable>& out) {
  Functions functions(data.size());
  for (const Channel channel : channels_of(data))
    for (const Axis a : kAllAxes) {
      std::set<int> runs;
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.channel(k) == channel && data.axis[k] == a) runs.insert(data.run[k]);
      if (runs.size() < 2 || runs.size() > kMostRuns) continue;
      const double share = 1.0 / static_cast<double>(runs.size());
      for (const int run : runs) {  // differences between runs: what all runs share depends on other variables
        const auto in_run = [&](std::size_t k) {
          if (data.channel(k) != channel || data.axis[k] != a) return 0.0;
          return (data.run[k] == run ? 1.0 : 0.0) - share;
        };
        functions.add(in_run);
        functions.add([&](std::size_t k) { return in_run(k) * scaled[k]; });
        functions.add([&](std::size_t k) { return in_run(k) * data.approach[k]; });
        if (runs.size() <= kMostRunsWithShape)
          for (std::size_t m = 2; m <= kWavesOfRun; ++m)
            functions.add([&](std::size_t k) {
              return in_run(k) * std::cos(0.5 * static_cast<double>(m) * std::numbers::pi * (scaled[k] + 1.0));
            });
      }
    }
  if (!functions.empty()) out.push_back({"run", functions.matrix()});
}

/// Without times the order of the rows serves as time: waves no faster than this many rows.
void add_rows(const Observations& data, std::vector<Variable>& out) {
  constexpr double kFastest_rows = 24.0;
  if (!data.time_s.empty() || data.row.empty()) return;
  const auto [least, greatest] = std::ranges::minmax_element(data.row);
  const double first = *least, length = static_cast<double>(*greatest) - first;
  if (length <= 0.0) return;
  Functions functions(data.size());
  const double waves = std::clamp(length / kFastest_rows, kFewestWavesOfTime, kMostWavesOfTime);
  for (const Channel channel : channels_of(data))
    for (int m = 1; m <= waves; ++m)
      functions.add([&](std::size_t k) {
        return data.channel(k) == channel ? std::cos(m * std::numbers::pi * (data.row[k] - first) / length) : 0.0;
      });
  out.push_back({"row", functions.matrix()});
}

void add_time(const Observations& data, std::vector<Variable>& out) {
  if (data.time_s.empty()) return;
  double last = 0.0;
  for (const double t : data.time_s)
    if (!std::isnan(t)) last = std::max(last, t);
  if (last <= 0.0) return;
  Functions functions(data.size());
  const double waves = std::clamp(last / kFastest_s, kFewestWavesOfTime, kMostWavesOfTime);
  for (const Channel channel : channels_of(data)) {
    functions.add([&](std::size_t k) { return data.channel(k) == channel ? data.time_s[k] / last : 0.0; });
    for (int m = 1; m <= waves; ++m)
      functions.add([&](std::size_t k) {
        return data.channel(k) == channel ? std::cos(m * std::numbers::pi * data.time_s[k] / last) : 0.0;
      });
  }
  out.push_back({"time_s", functions.matrix()});
}

/// A column of conditions: its levels, and its slope along the axis and with the approach.
void add_condition(const Observations& data, const std::string& name, const Column& column,
                   const std::vector<double>& scaled, std::vector<Variable>& out) {
  if (column.empty()) return;
  Functions functions(data.size());
  const auto value = [&](std::size_t k) { return cell(column, k); };
  double sum = 0.0, count = 0.0, least = kBeyondAll, greatest = -kBeyondAll;
  for (const double v : column)
    if (!std::isnan(v)) {
      sum += v;
      count += 1.0;
      least = std::min(least, v);
      greatest = std::max(greatest, v);
    }
  if (count < static_cast<double>(kFewestOfSense) || greatest <= least) return;
  const auto centred = [&](std::size_t k) { return (value(k) - sum / count) / (greatest - least); };
  for (const Channel channel : channels_of(data)) {
    add_levels(functions, data, channel, value, kMostConditionLevels, kOne);
    functions.add([&](std::size_t k) { return data.channel(k) == channel ? centred(k) * scaled[k] : 0.0; });
    functions.add([&](std::size_t k) { return data.channel(k) == channel ? centred(k) * data.approach[k] : 0.0; });
  }
  out.push_back({name, functions.matrix()});
}

void add_compensated(const Observations& data, const std::vector<double>& scaled, std::vector<Variable>& out) {
  const bool first = data.compensated.empty() || data.compensated.front();
  if (std::ranges::all_of(data.compensated, [&](bool c) { return c == first; })) return;
  Functions functions(data.size());
  for (const Channel channel : channels_of(data)) {
    const auto on = [&](std::size_t k) { return data.channel(k) == channel && data.compensated[k] ? 1.0 : 0.0; };
    functions.add(on);
    for (std::size_t m = 1; m <= kWavesOfMap; ++m)
      functions.add([&](std::size_t k) {
        return on(k) * std::cos(0.5 * static_cast<double>(m) * std::numbers::pi * (scaled[k] + 1.0));
      });
    functions.add([&](std::size_t k) { return on(k) * data.approach[k]; });
  }
  out.push_back({"compensated", functions.matrix()});
}

}  // namespace

std::vector<Variable> variables_of(const Observations& data) {
  std::vector<Variable> out;
  const std::vector<double> scaled = scaled_positions(data);
  add_positions(data, scaled, out);
  add_places_along(data, out);
  add_products(data, out);
  add_approach(data, scaled, out);
  add_runs(data, scaled, out);
  add_time(data, out);
  add_rows(data, out);
  add_condition(data, "feed_mm_min", data.feed_mm_min, scaled, out);
  add_condition(data, "load_kg", data.load_kg, scaled, out);
  add_condition(data, "travel_since_reversal_mm", data.travel_since_reversal_mm, scaled, out);
  add_condition(data, "pressure_hPa", data.pressure_hPa, scaled, out);
  add_condition(data, "humidity_pct", data.humidity_pct, scaled, out);
  for (const auto& [name, column] : data.sensors_degC) add_condition(data, name, column, scaled, out);
  for (const auto& [name, column] : data.extras)
    if (name != laser::kReadingSlopeColumn && name != kUncertaintyColumn)  // made of the readings
      add_condition(data, name, column, scaled, out);
  add_compensated(data, scaled, out);
  return out;
}

MatrixXd position_beside(const Observations& data, const std::string& variable) {
  Functions functions(data.size());
  for (const Channel channel : channels_of(data)) {
    std::set<Axis> moving;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.channel(k) == channel && !data.on_path(k)) moving.insert(data.axis[k]);
    for (const Axis axis : moving) {
      if (variable == data.position_name(axis)) continue;
      const auto here = [&](std::size_t k) { return !data.on_path(k) && data.axis[k] == axis; };
      add_levels(
          functions, data, channel, [&](std::size_t k) { return here(k) ? data.p_mm(k, axis) : kNotMeasured; },
          kMostLevels, kOne);
    }
  }
  for (std::size_t path = 0; path < data.paths.size(); ++path)
    if (variable != variable_along(data.paths[path]))
      add_levels(
          functions, data, kSenseChannels + static_cast<Channel>(path), [&](std::size_t k) { return data.along[k]; },
          kMostLevels, kOne);
  return functions.matrix();
}

const Space& BesidePosition::of(const std::string& variable) {
  const auto is_variable = [&](std::string_view name) { return variable == name; };
  const bool is_position =
      std::ranges::any_of(kAllAxes, [&](Axis axis) { return is_variable(data_.position_name(axis)); }) ||
      std::ranges::any_of(data_.paths, [&](const Path& path) { return is_variable(variable_along(path)); });
  const auto [made, is_new] = made_.try_emplace(is_position ? variable : "", space_);
  if (is_new) absorb(made->second, white_(position_beside(data_, variable)));
  return made->second;
}

namespace {

double share_beyond(Space space, double total, const Variable& variable, double noise_um) {
  if (total <= 0.0) return 0.0;
  const double before = space.chi2();
  const Index given = space.q.cols();
  absorb(space, variable.columns);
  const double explained = before - space.chi2();
  const double by_noise = static_cast<double>(space.q.cols() - given) * noise_um * noise_um;
  return std::clamp((explained - by_noise) / total, 0.0, 1.0);
}

BesidePosition beside_position(const Observations& data, const VectorXd& residual) {
  return {data, {MatrixXd(residual.size(), 0), residual}, [](const MatrixXd& columns) { return columns; }};
}

}  // namespace

double share_beyond_position(const Observations& data, const Variable& variable, const VectorXd& residual,
                             double noise_um) {
  return share_beyond(beside_position(data, residual).of(variable.name), residual.squaredNorm(), variable, noise_um);
}

std::vector<NamedShare> shares_by_variable(const Observations& data, const VectorXd& residual, double noise_um,
                                           const std::function<bool(const std::string&)>& is_wanted) {
  // their shares are known to a hundredth; the functions of a large set take hundreds of megabytes
  constexpr std::size_t kMostLookedAt = 20'000;
  if (data.size() > kMostLookedAt) {
    const std::vector<std::size_t> chosen = even_choice(data.size(), kMostLookedAt);
    VectorXd part(static_cast<Index>(chosen.size()));
    for (std::size_t i = 0; i < chosen.size(); ++i)
      part(static_cast<Index>(i)) = residual(static_cast<Index>(chosen[i]));
    return shares_by_variable(subset(data, chosen), part, noise_um, is_wanted);
  }
  std::vector<NamedShare> shares;
  BesidePosition beside = beside_position(data, residual);
  for (const Variable& variable : variables_of(data))
    if (is_wanted(variable.name))
      shares.push_back(
          {variable.name, share_beyond(beside.of(variable.name), residual.squaredNorm(), variable, noise_um)});
  return shares;
}

}  // namespace ecs::model
