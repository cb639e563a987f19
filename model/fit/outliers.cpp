// Hampel's identifier: distance from a median in units of the median absolute deviation (Hampel 1974; Davies and Gather
// 1993), against the largest of n normal deviates, √(2 ln n) (Donoho and Johnstone 1994).
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Neighbours looked at on either side: a choice; more smooth a curve away, fewer leave the median to chance.
constexpr std::size_t kReach = 3;
/// Readings of a pass below which neighbours say nothing: at least three of them beside the reading.
constexpr std::size_t kFewestInPass = 4;
/// Repeats below which the median of the others is one reading.
constexpr std::size_t kFewestRepeats = 3;
/// Readings below which no scale is known well enough; of this many at most one may be an outlier (5 %): isolated means
/// rare.
constexpr std::size_t kFewestReadings = 12, kReadingsAnOutlier = 20;
/// Where more look odd, only those that stand apart from the rest by this factor are outliers: what lies in between is
/// shape. A choice.
constexpr double kApart = 2.0;
/// This many of four in a row of a pass are no accident: a burst crosses zero in between.
constexpr std::size_t kStreak = 3, kInARow = 4;
/// Beyond the largest of n normal deviates by this much: the scale is estimated, and noise has longer tails. A choice.
constexpr double kMargin = 2.5;
/// √(2 ln n) holds for many; below this n it is taken at this n.
constexpr std::size_t kFewestForLimit = 10;

using Rows = std::vector<std::size_t>;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double robust_scale(const std::vector<double>& values) {
  std::vector<double> sizes;
  for (const double v : values)
    if (!std::isnan(v)) sizes.push_back(std::abs(v));
  return kSigmaPerMad * median(std::move(sizes));
}

std::vector<double> part(const std::vector<double>& all, const Rows& rows) {
  std::vector<double> values;
  for (const std::size_t k : rows) values.push_back(all[k]);
  return values;
}

/// Distance of each reading from the median of its neighbours in the same pass; NaN where there are too few.
std::vector<double> from_neighbours(const Observations& data, const Eigen::VectorXd& residual) {
  std::map<std::size_t, std::vector<std::size_t>> passes;
  const std::vector<std::size_t> pass = passes_of(data);
  for (std::size_t k = 0; k < pass.size(); ++k) passes[pass[k]].push_back(k);
  std::vector<double> distance(data.size(), kNotMeasured);
  for (const auto& [number, rows] : passes) {
    if (rows.size() < kFewestInPass) continue;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::vector<double> near;
      for (std::size_t j = i > kReach ? i - kReach : 0; j <= std::min(i + kReach, rows.size() - 1); ++j)
        if (j != i) near.push_back(residual(static_cast<Eigen::Index>(rows[j])));
      distance[rows[i]] = residual(static_cast<Eigen::Index>(rows[i])) - median(std::move(near));
    }
  }
  return distance;
}

/// Distance of each reading from the median of the other repeats; NaN below three repeats.
std::vector<double> from_repeats(const Observations& data, const Eigen::VectorXd& residual) {
  const Repeats repeats = places_of(data);
  std::vector<std::vector<std::size_t>> nodes(repeats.nodes);
  for (std::size_t k = 0; k < data.size(); ++k) nodes[repeats.node_of[k]].push_back(k);
  std::vector<double> distance(data.size(), kNotMeasured);
  for (const auto& rows : nodes) {
    if (rows.size() < kFewestRepeats) continue;
    for (const std::size_t k : rows) {
      std::vector<double> others;
      for (const std::size_t j : rows)
        if (j != k) others.push_back(residual(static_cast<Eigen::Index>(j)));
      distance[k] = residual(static_cast<Eigen::Index>(k)) - median(std::move(others));
    }
  }
  return distance;
}

/// How many of those that look odd, the oddest first, are isolated.
std::size_t isolated(const std::vector<std::pair<double, std::size_t>>& odd, std::size_t most) {
  if (odd.size() <= std::max<std::size_t>(most, 1)) return odd.size();
  for (std::size_t count = most; count > 0; --count)
    if (odd[count - 1].first > kApart * odd[count].first) return count;
  return 0;
}

/// Odd readings that follow each other in a pass are no isolated ones: something happened there. Two, one to each side,
/// are a jump that the model has smoothed.
void keep_streaks(const Observations& data, const std::vector<double>& oddness, std::vector<bool>& out) {
  const std::vector<std::size_t> pass = passes_of(data);
  std::map<std::size_t, Rows> passes;
  for (std::size_t k = 0; k < pass.size(); ++k) passes[pass[k]].push_back(k);
  const std::vector<bool> odd = out;
  for (const auto& [number, rows] : passes)
    for (std::size_t from = 0; from < rows.size(); ++from) {
      const std::size_t to = std::min(from + kInARow, rows.size());
      std::size_t count = 0;
      for (std::size_t i = from; i < to; ++i) count += odd[rows[i]] ? std::size_t{1} : std::size_t{0};
      for (std::size_t i = from; i < to && count >= kStreak; ++i) out[rows[i]] = false;
      if (from + 1 == rows.size()) continue;
      const std::size_t one = rows[from], next = rows[from + 1];
      if (odd[one] && odd[next] && oddness[one] * oddness[next] < 0.0) out[one] = out[next] = false;
    }
}

/// Nor is a reading that all passes over its target repeat, two at least, in its approach or in both: the machine does
/// that, a bad place or what follows a reversal.
void keep_repeated(const Observations& data, std::vector<bool>& out) {
  struct Target {
    std::set<std::size_t> passes;
    bool all_odd = true;
  };
  using Key = std::tuple<Channel, Axis, int, std::array<long long, kAxes>>;
  const std::vector<std::size_t> pass = passes_of(data);
  std::map<Key, Target> targets;
  const auto key = [&](std::size_t k, int approach) {
    const Vector3 place = data.place_of(k);
    std::array<long long, kAxes> rounded{};
    for (std::size_t a = 0; a < kAxes; ++a) rounded[a] = std::llround(place[a] / kSamePlace_mm);
    return Key{data.channel(k), data.axis[k], approach, rounded};
  };
  constexpr int kBoth = 0;
  const auto approaches = [&](std::size_t k) { return std::set{data.approach[k], kBoth}; };
  for (std::size_t k = 0; k < data.size(); ++k)
    for (const int approach : approaches(k)) {
      Target& target = targets[key(k, approach)];
      target.passes.insert(pass[k]);
      target.all_odd = target.all_odd && out[k];
    }
  const std::vector<bool> odd = out;
  for (std::size_t k = 0; k < data.size(); ++k)
    for (const int approach : approaches(k)) {
      const Target& target = targets[key(k, approach)];
      if (odd[k] && target.all_odd && target.passes.size() > 1) out[k] = false;
    }
}

/// Nor are the odd readings with which every pass of a line begins, two passes at least: the machine does that after a
/// reversal.
void keep_beginnings(const Observations& data, std::vector<bool>& out) {
  const std::vector<std::size_t> pass = passes_of(data);
  std::map<std::tuple<Channel, Axis, Vector3>, std::map<std::size_t, Rows>> lines;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!data.on_path(k)) lines[{data.channel(k), data.axis[k], data.parked_of(k)}][pass[k]].push_back(k);
  for (const auto& [line, passes] : lines) {
    const auto begins_odd = [&](const auto& one) { return out[one.second.front()]; };
    if (passes.size() < 2 || !std::ranges::all_of(passes, begins_odd)) continue;
    for (const auto& [number, rows] : passes)
      for (auto k = rows.begin(); k != rows.end() && out[*k]; ++k) out[*k] = false;
  }
}

/// A circle is read on the fly, where several readings follow a reversal closely: what a single pass shows within five
/// degrees of one, the axis does.
void keep_on_circles(const Observations& data, std::vector<bool>& out) {
  constexpr double kClose = 0.004;  // of the radius: 1 - cos 5 degrees
  const Repeats repeats = places_of(data);
  std::vector<std::size_t> readings(repeats.nodes);
  for (const std::size_t node : repeats.node_of) ++readings[node];
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (!out[k] || !data.on_path(k) || data.path_of(k).kind != PathKind::circle || readings[repeats.node_of[k]] > 1)
      continue;
    const PlaceOnPath place = place_on(data.path_of(k), data.position_mm[k], data.approach[k]);
    if (std::ranges::any_of(place.since_reversal_mm,
                            [&](const auto& mm) { return mm && *mm < kClose * data.path_of(k).radius_mm; }))
      out[k] = false;
  }
}

/// Each distance in the robust scale of its kind; NaN where there is none.
std::vector<double> in_scale(std::vector<double> distance, const std::map<std::pair<Channel, Axis>, Rows>& groups) {
  for (const auto& [kind, rows] : groups) {
    const double scale = robust_scale(part(distance, rows));
    for (const std::size_t k : rows) distance[k] = scale > 0.0 ? distance[k] / scale : kNotMeasured;
  }
  return distance;
}

/// How far the other readings of its run, all or those of its kind, are from their repeats, at least 1: a visit that
/// arrives elsewhere is off as a whole, and none of its readings is isolated. A visit shows several senses at once.
double scale_of_run(const Observations& data, const std::vector<double>& by_repeats, std::size_t k) {
  constexpr std::size_t kFewest = 4;
  std::vector<double> all, kind;
  for (std::size_t j = 0; j < data.size(); ++j) {
    if (j == k || data.run[j] != data.run[k]) continue;
    all.push_back(by_repeats[j]);
    if (data.channel(j) == data.channel(k) && data.axis[j] == data.axis[k]) kind.push_back(by_repeats[j]);
  }
  if (all.size() < kFewest || kind.size() == all.size()) return 1.0;
  return std::max({1.0, robust_scale(all), robust_scale(kind)});
}

/// How odd each reading is, in the scale of its sense and axis, and to which side; 0 where it is not.
std::vector<double> oddness_of(const Observations& data, const Eigen::VectorXd& residual,
                               const std::map<std::pair<Channel, Axis>, Rows>& groups) {
  const std::vector<double> by_near = in_scale(from_neighbours(data, residual), groups);
  const std::vector<double> by_repeats = in_scale(from_repeats(data, residual), groups);
  std::vector<double> oddness(data.size(), 0.0);
  for (const auto& [kind, rows] : groups) {
    const double limit =
        kMargin + std::sqrt(2.0 * std::log(static_cast<double>(std::max(rows.size(), kFewestForLimit))));
    for (const std::size_t k : rows) {
      const bool no_neighbours = std::isnan(by_near[k]), no_repeats = std::isnan(by_repeats[k]);
      if ((no_neighbours && no_repeats) || std::abs(by_near[k]) <= limit || std::abs(by_repeats[k]) <= limit) continue;
      if (no_neighbours && std::abs(by_repeats[k]) <= limit * scale_of_run(data, by_repeats, k)) continue;
      oddness[k] = no_neighbours ? by_repeats[k] : by_near[k];
    }
  }
  return oddness;
}

}  // namespace

std::vector<bool> isolated_outliers(const Observations& data, const Eigen::VectorXd& residual) {
  std::vector<bool> out(data.size(), false);
  if (data.size() < kFewestReadings) return out;
  std::map<std::pair<Channel, Axis>, Rows> groups;
  for (std::size_t k = 0; k < data.size(); ++k) groups[{data.channel(k), data.axis[k]}].push_back(k);
  Eigen::VectorXd weighed = residual;
  const std::vector<double> relative = relative_uncertainty(data);
  for (std::size_t k = 0; k < relative.size(); ++k) weighed(static_cast<Eigen::Index>(k)) /= relative[k];
  const std::vector<double> oddness = oddness_of(data, weighed, groups);
  for (const auto& [place, rows] : groups) {
    std::vector<std::pair<double, std::size_t>> found;
    for (const std::size_t k : rows)
      if (oddness[k] != 0.0) found.emplace_back(std::abs(oddness[k]), k);
    std::ranges::sort(found, std::greater<>());
    for (std::size_t i = 0; i < isolated(found, rows.size() / kReadingsAnOutlier); ++i) out[found[i].second] = true;
  }
  if (std::ranges::find(out, true) == out.end()) return out;
  keep_streaks(data, oddness, out);
  keep_repeated(data, out);
  keep_beginnings(data, out);
  keep_on_circles(data, out);
  return out;
}

std::vector<bool> of_unknown_approach(const Observations& data) {
  constexpr std::size_t kReadingsAnUnknown = 5;
  std::map<std::tuple<Channel, Axis, int>, std::pair<std::size_t, std::size_t>> runs;  // unknown, of all
  const auto key = [&](std::size_t k) { return std::tuple(data.channel(k), data.axis[k], data.run[k]); };
  for (std::size_t k = 0; k < data.size(); ++k) {
    auto& [unknown, all] = runs[key(k)];
    unknown += data.approach[k] == 0 ? 1U : 0U;
    ++all;
  }
  std::vector<bool> out(data.size(), false);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto& [unknown, all] = runs[key(k)];
    out[k] = data.approach[k] == 0 && !data.on_path(k) && kReadingsAnUnknown * unknown <= all;
  }
  return out;
}

std::vector<bool> without_sensor(const Observations& data) {
  constexpr std::size_t kReadingsAMissing = 3;
  std::vector<bool> out(data.size(), false);
  for (const auto& [name, degC] : data.sensors_degC) {
    std::map<std::pair<Channel, Axis>, std::pair<std::size_t, std::size_t>> kinds;  // missing, of all
    const auto of_kind = [&](std::size_t k) -> auto& { return kinds[{data.channel(k), data.axis[k]}]; };
    for (std::size_t k = 0; k < data.size(); ++k) {
      of_kind(k).first += std::isnan(cell(degC, k)) ? 1U : 0U;
      ++of_kind(k).second;
    }
    for (std::size_t k = 0; k < data.size(); ++k)
      if (std::isnan(cell(degC, k)) && kReadingsAMissing * of_kind(k).first <= of_kind(k).second) out[k] = true;
  }
  return out;
}

Observations with_sensors(const Observations& data) {
  const std::vector<bool> missing = without_sensor(data);
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!missing[k]) kept.push_back(k);
  return kept.size() == data.size() ? data : subset(data, kept);
}

std::vector<bool> rows_unusable(const Observations& data) {
  std::vector<bool> out = of_unknown_approach(data);
  const std::vector<bool> missing = without_sensor(data);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = out[k] || missing[k];
  return out;
}

std::optional<std::string> note_of_missing_sensors(const Observations& data) {
  const std::vector<bool> missing = without_sensor(data);
  const auto count = std::ranges::count(missing, true);
  if (count == 0) return std::nullopt;
  return fmt::format(
      "{} of {} readings lack a temperature that most readings of their kind have: they are left out of every fit",
      count, data.size());
}

std::vector<bool> rows_left_out(const Observations& data, const Eigen::VectorXd& residual) {
  std::vector<bool> out = isolated_outliers(data, residual);
  const std::vector<bool> unusable = rows_unusable(data);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = out[k] || unusable[k];
  return out;
}

}  // namespace ecs::model
