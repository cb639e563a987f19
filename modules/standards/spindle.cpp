#include "modules/standards/spindle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "laser/csv_table.hpp"
#include "laser/groups.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/zone.hpp"

namespace ecs::laser {
namespace {

constexpr double kFullTurn_deg = 360.0;
constexpr double kWidestStep = 1.0 / static_cast<double>(kLeastReadingsPerTurn);  // turns
/// Below it a note says that the asynchronous value still grows with the turns; a choice.
constexpr std::size_t kUsualTurns = 20;
/// More are not evaluated; a choice.
constexpr double kMostAngles = 1440.0;
constexpr double kLargestReading_um = 1e4;
constexpr double kLargestSpeed_rpm = 1e6;
constexpr double kSecondsPerMinute = 60.0;
constexpr int kMostPerTurn = 8;

template <class Values>
double range_of(const Values& values) {
  const auto [least, greatest] = std::ranges::minmax_element(values);
  return *greatest - *least;
}

std::vector<double> steps_of(const std::vector<double>& values) {
  std::vector<double> steps(values.size());
  std::adjacent_difference(values.begin(), values.end(), steps.begin());
  steps.erase(steps.begin());
  return steps;
}

/// Least squares of values by K columns, each a function of the reading's number.
template <std::size_t K, class Columns>
std::array<double, K> fitted(const std::vector<double>& values, std::size_t count, const Columns& columns_at) {
  constexpr auto kCount = static_cast<Eigen::Index>(K);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kCount, kCount);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kCount);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<double, K> row = columns_at(i);
    const Eigen::Map<const Eigen::Matrix<double, static_cast<int>(K), 1>> column(row.data());
    gram += column * column.transpose();
    right += column * values[i];
  }
  const Eigen::VectorXd sizes = SymmetricSolver(gram).solve(right);
  std::array<double, K> out{};
  std::copy(sizes.begin(), sizes.end(), out.begin());
  return out;
}

/// The last one ends within a step behind the last reading, or within another where a mark of the spindle is uncertain.
std::size_t whole_turns(const SpindleTrace& trace) {
  return static_cast<std::size_t>(trace.turn.back() + 2.0 * median_of(steps_of(trace.turn)));
}

/// A table on its way to a trace.
class TraceTable {
 public:
  TraceTable(const CsvTable& table, Findings& findings)
      : table_(table), findings_(findings), reader_(table, findings) {}

  SpindleTrace trace(const std::string& file_name) {
    trace_.source = file_name;
    check_columns();
    take_head();
    if (findings_.empty()) take_sensors();
    if (findings_.empty()) take_turns();
    if (findings_.empty()) check_turns();
    if (findings_.empty()) check_sensors();
    return std::move(trace_);
  }

 private:
  [[nodiscard]] bool has(SpindleSensor sensor) const {
    return reader_.has(kSpindleColumns[static_cast<std::size_t>(sensor)]);
  }

  void refuse(std::size_t row, std::string_view column, std::string message) {
    reader_.take(table_.rows[row]);
    reader_.refuse(column, std::move(message));
  }

  void check_columns() {
    using enum SpindleSensor;
    if (!has(x) && !has(y) && !has(z))
      findings_.add(table_.header_line, 1, "header: expected a column x_um, y_um or z_um, found none");
    if (has(x2) && !has(x)) findings_.add(table_.header_line, 1, "header: x2_um needs a column x_um, found none");
    if (has(y2) && !has(y)) findings_.add(table_.header_line, 1, "header: y2_um needs a column y_um, found none");
    if (!reader_.has("angle_deg") && !reader_.has("index") && !(reader_.has("time_s") && reader_.stated("speed_rpm")))
      findings_.add(table_.header_line, 1,
                    "header: expected a column angle_deg, or index (1 where a turn begins), or time_s below "
                    "`# speed_rpm: `, found none");
  }

  std::optional<double> above_zero(std::string_view key, double most) {
    const auto value = reader_.stated_number(key);
    if (!value || (*value > 0.0 && *value <= most)) return value;
    findings_.add(0, 0, "{}: expected a number above 0, at most {:g}, found {:g}", key, most, *value);
    return std::nullopt;
  }

  void take_head() {
    constexpr double kFurthest_mm = 1e4;
    trace_.speed_rpm = above_zero("speed_rpm", kLargestSpeed_rpm);
    trace_.noise_um = above_zero("noise_um", kLargestReading_um);
    trace_.planes_mm = above_zero("planes_mm", kFurthest_mm);
    if ((has(SpindleSensor::x2) || has(SpindleSensor::y2)) && !reader_.stated("planes_mm"))
      findings_.add(0, 0, "expected `# planes_mm: ` with the distance of the two planes, found none");
  }

  std::vector<double> numbers(std::string_view column, double most) {
    std::vector<double> values;
    for (const CsvRow& row : table_.rows) {
      reader_.take(row);
      values.push_back(reader_.number(column, most).value_or(0.0));
    }
    return values;
  }

  void take_sensors() {
    for (std::size_t s = 0; s < kSpindleColumns.size(); ++s)
      if (reader_.has(kSpindleColumns[s])) trace_.value_um[s] = numbers(kSpindleColumns[s], kLargestReading_um);
    if (table_.rows.size() < kLeastSpindleTurns * kLeastReadingsPerTurn)
      findings_.add(table_.header_line, 0, "expected {} turns or more of {} readings or more, found {} readings",
                    kLeastSpindleTurns, kLeastReadingsPerTurn, table_.rows.size());
  }

  void take_turns() {
    if (reader_.has("angle_deg"))
      turns_by_angle();
    else if (reader_.has("index"))
      turns_by_index();
    else
      turns_by_speed();
  }

  void turns_by_angle() {
    constexpr double kLargestAngle_deg = 1e9;
    const auto angles_deg = numbers("angle_deg", kLargestAngle_deg);
    if (!findings_.empty()) return;
    std::vector<double> steps = steps_of(angles_deg);  // turns
    for (double& step : steps) {
      step /= kFullTurn_deg;
      if (std::abs(step) > 0.5) step -= std::round(step);
    }
    trace_.falling = std::accumulate(steps.begin(), steps.end(), 0.0) < 0.0;
    trace_.first_deg = folded_deg(angles_deg.front());
    trace_.has_origin = true;
    trace_.turn = {0.0};
    const double usual = std::abs(median_of(steps));
    if (usual == 0.0)
      findings_.add(table_.header_line, 0, "angle_deg: expected an angle that changes from reading to reading");
    for (std::size_t i = 0; i < steps.size() && findings_.empty(); ++i) {
      const double step = trace_.falling ? -steps[i] : steps[i];
      if (step < 0.0)
        refuse(i + 1, "angle_deg",
               fmt::format("angle_deg: the direction of rotation reverses, from {:g} to {:g} degrees. Record one "
                           "direction in a file",
                           angles_deg[i], angles_deg[i + 1]));
      else if (usual <= kWidestStep)
        check_step(i + 1, step, "angle_deg");
      trace_.turn.push_back(trace_.turn.back() + step);
    }
    if (findings_.empty()) note_gaps(trace_.turn, kFullTurn_deg, "degrees");
  }

  void check_step(std::size_t row, double turns, std::string_view column) {
    if (turns > kWidestStep)
      refuse(row, column,
             fmt::format("{}: expected a step of {:g} degrees at most, found {:.4g}. Are rows missing?", column,
                         kWidestStep * kFullTurn_deg, turns * kFullTurn_deg));
  }

  /// Rising times, or the numbers of the rows.
  std::vector<double> times() {
    constexpr double kLongest_s = 1e9;
    std::vector<double> all(table_.rows.size());
    std::iota(all.begin(), all.end(), 0.0);
    if (!reader_.has("time_s")) return all;
    all = numbers("time_s", kLongest_s);
    for (std::size_t i = 1; i < all.size() && findings_.empty(); ++i)
      if (all[i] <= all[i - 1])
        refuse(i, "time_s", fmt::format("time_s: expected a time after {:g}, found {:g}", all[i - 1], all[i]));
    if (findings_.empty()) note_gaps(all, 1.0, "s");
    return all;
  }

  void note_gaps(const std::vector<double>& places, double factor, std::string_view unit) {
    constexpr double kGap = 1.5;  // of the usual step: a missing row makes 2
    const auto steps = steps_of(places);
    const double usual = median_of(steps);
    const auto gaps = std::ranges::count_if(steps, [&](double step) { return step > kGap * usual; });
    if (gaps == 0) return;
    const auto widest = std::ranges::max_element(steps);
    trace_.notes.push_back(fmt::format(
        "{} of the steps from reading to reading are longer than {:g} times the usual one. The longest, {:.4g} {}, "
        "ends "
        "at line {}. Rows may be missing; readings are interpolated there.",
        gaps, kGap, *widest * factor, unit, table_.rows[static_cast<std::size_t>(widest - steps.begin()) + 1].line));
  }

  void turns_by_index() {
    constexpr double kUneven = 0.05;
    const auto index = numbers("index", kLargestReading_um);
    const auto time = times();
    if (!findings_.empty()) return;
    std::vector<std::size_t> pulses;
    for (std::size_t i = 1; i < index.size(); ++i)
      if (index[i] != 0.0 && index[i - 1] == 0.0) pulses.push_back(i);
    if (pulses.size() < kLeastSpindleTurns + 1) {
      findings_.add(table_.header_line, 0,
                    "index: expected {} turns or more, each from a row that is not 0 behind a row of 0 to the next, "
                    "found {} such rows",
                    kLeastSpindleTurns, pulses.size());
      return;
    }
    std::vector<double> at;
    for (const std::size_t pulse : pulses) at.push_back(time[pulse]);
    const double step = median_of(steps_of(time)), usual = median_of(steps_of(at));
    for (std::size_t p = 1; p < at.size(); ++p)
      if (const double length = at[p] - at[p - 1]; std::abs(length - usual) > kUneven * usual + step)
        refuse(pulses[p], "index",
               fmt::format("index: the turn that ends here takes {:.4g} readings, the usual one {:.4g}. Rows or pulses "
                           "are missing, there is a pulse too many, or the speed changed",
                           length / step, usual / step));
    if (!findings_.empty()) return;
    if (reader_.has("time_s"))
      trace_.speed_rpm = kSecondsPerMinute * static_cast<double>(at.size() - 1) / (at.back() - at.front());
    turns_between(pulses, at, time, step);
  }

  /// A turn begins within the step before its row. Where all pulses fit one speed, that speed gives the turns: a single
  /// pulse is uncertain by a step.
  void turns_between(const std::vector<std::size_t>& pulses, const std::vector<double>& at,
                     const std::vector<double>& time, double step) {
    const auto [from, per_turn] = fitted<2>(at, at.size(), [](std::size_t p) {
      return std::array{1.0, static_cast<double>(p)};
    });
    double worst = 0.0;
    for (std::size_t p = 0; p < at.size(); ++p)
      worst = std::max(worst, std::abs(at[p] - from - per_turn * static_cast<double>(p)));
    const bool steady = worst <= step;
    if (!steady)
      trace_.notes.push_back(fmt::format(
          "The speed varies: each turn is divided evenly between its pulses, which are uncertain by a step of {:.2g} "
          "degrees.",
          kFullTurn_deg * step / per_turn));
    std::vector<double> turn;
    std::size_t p = 0;
    for (std::size_t i = pulses.front(); i < pulses.back(); ++i) {
      while (i >= pulses[p + 1]) ++p;
      turn.push_back(steady ? (time[i] - from + step / 2.0) / per_turn
                            : static_cast<double>(p) + (time[i] - at[p]) / (at[p + 1] - at[p]));
    }
    first_row_ = pulses.front();
    for (std::vector<double>& values : trace_.value_um)
      if (!values.empty())
        values = {values.begin() + static_cast<std::ptrdiff_t>(first_row_),
                  values.begin() + static_cast<std::ptrdiff_t>(pulses.back())};
    trace_.has_origin = true;
    trace_.first_deg = folded_deg(turn.front() * kFullTurn_deg);
    for (const double one : turn) trace_.turn.push_back(one - turn.front());
    if (!steady) return;
    const auto factor = stretch();  // the pulses leave a step over all turns
    if (factor && std::abs(*factor - 1.0) * trace_.turn.back() * per_turn <= 2.0 * step)
      for (double& one : trace_.turn) one *= *factor;
  }

  void turns_by_speed() {
    const auto time = times();
    if (!findings_.empty()) return;
    for (const double one : time) trace_.turn.push_back((one - time.front()) * *trace_.speed_rpm / kSecondsPerMinute);
    if (median_of(steps_of(trace_.turn)) <= kWidestStep) correct_speed();
  }

  /// The radial sensor with the greatest range, else the axial one.
  [[nodiscard]] std::size_t sensor_of_eccentricity() const {
    constexpr auto kAxial = static_cast<std::size_t>(SpindleSensor::z);
    const bool is_axial_only = trace_.of(SpindleSensor::x).empty() && trace_.of(SpindleSensor::y).empty();
    std::size_t best = kAxial;
    double widest = -1.0;
    for (std::size_t s = 0; s < kSpindleColumns.size(); ++s) {
      const auto& values = trace_.value_um[s];
      if (values.empty() || (s == kAxial && !is_axial_only) || range_of(values) <= widest) continue;
      widest = range_of(values);
      best = s;
    }
    return best;
  }

  /// By how much the turns have to be stretched for the once-per-turn motion to keep its phase; nothing where it does
  /// not stand out. With φ = 2π·turn and a slip of δ·v, v from 0 to 1: a·cos(φ + δv) + b·sin(φ + δv) = a·cos φ + b·sin
  /// φ
  /// + δ·v·(b·cos φ − a·sin φ), beside waves of 2 to 4 per turn; repeated, of a window that grows, so that δ stays
  /// small.
  [[nodiscard]] std::optional<double> stretch() const {
    constexpr double kStandsOut = 0.35;  // of the range; a wave alone has a half
    constexpr int kRepeats = 4;
    const auto& values = trace_.value_um[sensor_of_eccentricity()];
    double factor = 1.0, amplitude = 0.0;
    for (double window = static_cast<double>(kLeastSpindleTurns);; window *= 2.0) {
      const auto count = static_cast<std::size_t>(std::ranges::lower_bound(trace_.turn, window) - trace_.turn.begin());
      if (count < kLeastSpindleTurns * kLeastReadingsPerTurn && count < trace_.turn.size()) continue;
      const double length = trace_.turn[count - 1];
      for (int repeat = 0; repeat < kRepeats; ++repeat) {
        const auto sizes = fitted<12>(values, count, [&](std::size_t i) {
          const double v = trace_.turn[i] / length, angle = kTurn * trace_.turn[i] * factor;
          const double c = std::cos(angle), s = std::sin(angle);
          return std::array{1.0,
                            v,
                            c,
                            s,
                            v * c,
                            v * s,
                            std::cos(2.0 * angle),
                            std::sin(2.0 * angle),
                            std::cos(3.0 * angle),
                            std::sin(3.0 * angle),
                            std::cos(4.0 * angle),
                            std::sin(4.0 * angle)};
        });
        amplitude = std::hypot(sizes[2], sizes[3]);
        factor += (sizes[4] * sizes[3] - sizes[5] * sizes[2]) / (amplitude * amplitude) / (kTurn * length);
      }
      if (count == trace_.turn.size()) break;
    }
    if (!(amplitude > 0.0 && amplitude >= kStandsOut * range_of(values)) || !std::isfinite(factor)) return std::nullopt;
    return factor;
  }

  void correct_speed() {
    constexpr double kFurthest = 0.02;  // of the stated speed; a choice
    const std::string_view column = kSpindleColumns[sensor_of_eccentricity()];
    const auto factor = stretch();
    if (!factor) {
      trace_.notes.push_back(fmt::format(
          "The speed is taken as stated: no motion once per turn stands out in {} that could confirm it.", column));
      return;
    }
    const double fitted_rpm = *trace_.speed_rpm * *factor;
    if (std::abs(*factor - 1.0) > kFurthest) {
      findings_.add(0, 0, "speed_rpm: the once-per-turn motion of {} fits {:.6g}, found {:g}. Correct the speed",
                    column, fitted_rpm, *trace_.speed_rpm);
      return;
    }
    trace_.notes.push_back(fmt::format("Speed {:.6g} rpm by the once-per-turn motion of {}, stated {:g}.", fitted_rpm,
                                       column, *trace_.speed_rpm));
    trace_.speed_rpm = fitted_rpm;
    for (double& turn : trace_.turn) turn *= *factor;
  }

  void check_turns() {
    const std::vector<double> steps = steps_of(trace_.turn);
    const double usual = median_of(steps);
    if (usual > kWidestStep || trace_.turn.back() + 2.0 * usual < static_cast<double>(kLeastSpindleTurns)) {
      findings_.add(table_.header_line, 0,
                    "expected {} turns or more of {} readings or more, found {:.1f} turns of {:.0f} readings",
                    kLeastSpindleTurns, kLeastReadingsPerTurn, trace_.turn.back() + usual, 1.0 / usual);
      return;
    }
    const std::string_view column = reader_.has("angle_deg") ? "angle_deg" : reader_.has("index") ? "index" : "time_s";
    for (std::size_t i = 0; i < steps.size(); ++i) check_step(first_row_ + i + 1, steps[i], column);
  }

  void check_sensors() {
    for (std::size_t s = 0; s < kSpindleColumns.size(); ++s) {
      if (trace_.value_um[s].empty()) continue;
      const auto [lowest, highest] = std::ranges::minmax_element(trace_.value_um[s]);
      const double least = *lowest, greatest = *highest;
      if (least == greatest) {
        refuse(first_row_, kSpindleColumns[s],
               fmt::format("{}: all readings are {:g}. Check the sensor", kSpindleColumns[s], least));
        continue;
      }
      check_range(s, greatest, "greatest", greatest - least);
      check_range(s, least, "least", greatest - least);
    }
  }

  /// Readings stay at an extreme longer than the resolution explains on the crest of a wave once per turn, where
  /// cos φ > 1 − resolution / amplitude.
  void check_range(std::size_t sensor, double extreme, std::string_view which, double range) {
    constexpr std::size_t kEqualByChance = 8;  // equal readings that say nothing
    constexpr double kMargin = 2.0;
    const auto& values = trace_.value_um[sensor];
    std::size_t longest = 0, end = 0, run = 0;
    double resolution = range;
    for (std::size_t i = 0; i < values.size(); ++i) {
      run = values[i] == extreme ? run + 1 : 0;
      if (run == 0) resolution = std::min(resolution, std::abs(values[i] - extreme));
      if (run <= longest) continue;
      longest = run;
      end = i;
    }
    const double crest = std::acos(std::max(-1.0, 1.0 - 2.0 * resolution / range)) / std::numbers::pi;  // turns
    const double per_turn = 1.0 / median_of(steps_of(trace_.turn));
    if (longest <= kEqualByChance || static_cast<double>(longest) < kMargin * crest * per_turn) return;
    refuse(first_row_ + end + 1 - longest, kSpindleColumns[sensor],
           fmt::format("{}: {} readings in a row are {:g}, the {} of all: the sensor is beyond its range, or its "
                       "resolution is too coarse. Centre the ball or choose a larger range",
                       kSpindleColumns[sensor], longest, extreme, which));
  }

  const CsvTable& table_;
  Findings& findings_;
  TableReader reader_;
  SpindleTrace trace_;
  std::size_t first_row_ = 0;  ///< that became the first reading
};

}  // namespace

Result<SpindleTrace> parse_spindle_trace(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, {}, findings));
  SpindleTrace trace = TraceTable(table, findings).trace(file_name);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return trace;
}

namespace {

using Turns = std::vector<std::vector<double>>;  // (turns × angles)

Turns combined(const Turns& a, const Turns& b, const auto& make) {
  Turns out = a;
  for (std::size_t t = 0; t < a.size(); ++t)
    for (std::size_t m = 0; m < a[t].size(); ++m) out[t][m] = make(a[t][m], b[t][m], m);
  return out;
}

/// At the same angles of every turn, linear between readings. What comes once per turn is large and is taken out before
/// and put back after, so that the chords of its circle cut nothing off.
Turns resampled(const SpindleTrace& trace, const std::vector<double>& values, std::size_t turns, std::size_t angles) {
  const double whole = trace.turn.back();
  const auto sizes = fitted<5>(values, values.size(), [&](std::size_t i) {
    const double v = 2.0 * trace.turn[i] / whole - 1.0, angle = kTurn * trace.turn[i];
    return std::array{1.0, v, v * v, std::cos(angle), std::sin(angle)};
  });
  const auto once = [&](double turn) { return sizes[3] * std::cos(kTurn * turn) + sizes[4] * std::sin(kTurn * turn); };
  const auto rest = [&](std::size_t i) { return values[i] - once(trace.turn[i]); };
  Turns out(turns, std::vector<double>(angles));
  std::size_t above = 1;
  for (std::size_t t = 0; t < turns; ++t)
    for (std::size_t m = 0; m < angles; ++m) {
      const double at = static_cast<double>(t) + static_cast<double>(m) / static_cast<double>(angles);
      while (above + 1 < trace.turn.size() && trace.turn[above] < at) ++above;
      const double low = trace.turn[above - 1], high = trace.turn[above];
      const double share = high > low ? std::clamp((at - low) / (high - low), 0.0, 1.0) : 1.0;
      out[t][m] = std::lerp(rest(above - 1), rest(above), share) + once(at);
    }
  return out;
}

std::vector<double> means_of(const Turns& turns) {
  std::vector<double> means;
  for (const auto& turn : turns) means.push_back(*mean_of(turn));
  return means;
}

/// Drift of one sensor: a parabola through the means of its turns, over the turns.
struct Parabola {
  std::array<double, 3> sizes{};
  [[nodiscard]] double at(double turns) const { return sizes[0] + (sizes[1] + sizes[2] * turns) * turns; }
};

/// @param middle  of the readings of a turn: a half less half a step
Parabola parabola_of(const std::vector<double>& means, double middle) {
  return {fitted<3>(means, means.size(), [middle](std::size_t t) {
    const double at = static_cast<double>(t) + middle;
    return std::array{1.0, at, at * at};
  })};
}

Turns without_drift(Turns turns, const Parabola& drift) {
  for (std::size_t t = 0; t < turns.size(); ++t)
    for (std::size_t m = 0; m < turns[t].size(); ++m)
      turns[t][m] -= drift.at(static_cast<double>(t) + static_cast<double>(m) / static_cast<double>(turns[t].size()));
  return turns;
}

Turns without_mean(Turns turns) {
  const double mean = *mean_of(means_of(turns));
  for (auto& turn : turns)
    for (double& value : turn) value -= mean;
  return turns;
}

/// Coefficients of cos and sin of a whole number of waves over even angles: least squares.
std::array<double, 2> wave_in(const std::vector<double>& values, const std::vector<double>& angle_deg, int per_turn) {
  std::array<double, 2> sum{};
  for (std::size_t m = 0; m < values.size(); ++m) {
    const double angle = kTurn * per_turn * angle_deg[m] / kFullTurn_deg;
    sum[0] += 2.0 * values[m] * std::cos(angle) / static_cast<double>(values.size());
    sum[1] += 2.0 * values[m] * std::sin(angle) / static_cast<double>(values.size());
  }
  return sum;
}

/// Of the mean of the turns; its uncertainty from the scatter of the coefficients over the turns.
SpindleWave wave_of(const Turns& turns, const std::vector<double>& angle_deg, int per_turn) {
  const double count = static_cast<double>(turns.size());
  std::array<double, 2> mean{}, squares{};
  for (const auto& turn : turns) {
    const auto one = wave_in(turn, angle_deg, per_turn);
    for (std::size_t i = 0; i < 2; ++i) {
      mean[i] += one[i] / count;
      squares[i] += one[i] * one[i];
    }
  }
  double scatter = 0.0;
  for (std::size_t i = 0; i < 2; ++i) scatter += std::max(0.0, squares[i] - count * mean[i] * mean[i]) / (count - 1.0);
  const double at_deg = std::atan2(mean[1], mean[0]) * kFullTurn_deg / kTurn / per_turn;
  return {per_turn, std::hypot(mean[0], mean[1]), std::sqrt(scatter / 2.0 / count),
          at_deg < 0.0 ? at_deg + kFullTurn_deg / per_turn : at_deg};
}

double zone_width(const std::vector<double>& curve, const std::vector<double>& angle_deg) {
  std::vector<ZonePoint> points;
  for (std::size_t m = 0; m < curve.size(); ++m) {
    const double angle = kTurn * angle_deg[m] / kFullTurn_deg;
    points.push_back({std::cos(angle), std::sin(angle), curve[m]});
  }
  return minimum_zone(points).width();
}

/// The widest range of the turns at one angle, and its place.
std::pair<double, std::size_t> widest_range(const Turns& turns) {
  std::pair<double, std::size_t> widest{-1.0, 0};
  for (std::size_t m = 0; m < turns.front().size(); ++m) {
    double least = turns.front()[m], greatest = least;
    for (const auto& turn : turns) {
      least = std::min(least, turn[m]);
      greatest = std::max(greatest, turn[m]);
    }
    if (greatest - least > widest.first) widest = {greatest - least, m};
  }
  return widest;
}

std::vector<double> without_wave(std::vector<double> values, const std::vector<double>& angle_deg,
                                 const SpindleWave& wave) {
  for (std::size_t m = 0; m < values.size(); ++m)
    values[m] -= wave.amplitude * std::cos(kTurn * wave.per_turn * (angle_deg[m] - wave.at_deg) / kFullTurn_deg);
  return values;
}

/// What noise of deviation 1 gives over these turns and angles.
struct UnitNoise {
  double asynchronous = 0.0, synchronous = 0.0;
  [[nodiscard]] SpindleNoise times(double rms) const { return {rms, rms * asynchronous, rms * synchronous}; }
};

/// What the values of a motion are made from.
struct RawMotion {
  SpindleMotion motion;
  Turns with_drift, steady;
};

SpindleMotion evaluated(RawMotion raw, const std::vector<double>& angle_deg, const UnitNoise& noise,
                        std::optional<double> sensor_noise) {
  SpindleMotion& motion = raw.motion;
  const std::size_t turns = raw.steady.size(), angles = angle_deg.size();
  motion.angle_deg = angle_deg;
  motion.once = wave_of(raw.steady, angle_deg, 1);
  motion.turns = without_mean(std::move(raw.steady));
  if (motion.is_radial)
    for (auto& turn : motion.turns) turn = without_wave(std::move(turn), angle_deg, motion.once);
  motion.mean.assign(angles, 0.0);
  for (const auto& turn : motion.turns)
    for (std::size_t m = 0; m < angles; ++m) motion.mean[m] += turn[m] / static_cast<double>(turns);
  double squares = 0.0, least = motion.mean.front(), greatest = least;
  for (const auto& turn : motion.turns)
    for (std::size_t m = 0; m < angles; ++m) {
      least = std::min(least, turn[m]);
      greatest = std::max(greatest, turn[m]);
      squares += (turn[m] - motion.mean[m]) * (turn[m] - motion.mean[m]);
    }
  motion.total = greatest - least;
  motion.synchronous = range_of(motion.mean);
  if (motion.is_radial)
    motion.synchronous_zone = zone_width(motion.mean, angle_deg);
  else
    motion.residual_synchronous = range_of(without_wave(motion.mean, angle_deg, motion.once));
  const auto [asynchronous, place] = widest_range(motion.turns);
  motion.asynchronous = asynchronous;
  motion.asynchronous_deg = angle_deg[place];
  motion.asynchronous_drift = widest_range(raw.with_drift).first;
  motion.asynchronous_rms = std::sqrt(squares / static_cast<double>((turns - 1) * angles));
  motion.if_noise = noise.times(motion.asynchronous_rms);
  if (sensor_noise) motion.of_sensor = noise.times(*sensor_noise);
  for (int k = 2; k <= kMostPerTurn; ++k) motion.waves.push_back(wave_of(motion.turns, angle_deg, k));
  return std::move(motion);
}

RawMotion fixed_motion(SpindleMotion motion, Turns turns) {
  const std::vector<double> means = means_of(turns);
  const double middle = 0.5 - 0.5 / static_cast<double>(turns.front().size());
  const Parabola drift = parabola_of(means, middle);
  motion.drift = drift.at(static_cast<double>(turns.size()) - 1.0 + middle) - drift.at(middle);
  for (const double mean : means) motion.turn_means.push_back(mean - means.front());
  Turns steady = without_drift(turns, drift);
  return {std::move(motion), std::move(turns), std::move(steady)};
}

RawMotion rotating_motion(SpindleMotion motion, const RawMotion& x, const RawMotion& y,
                          const std::vector<double>& angle_deg) {
  motion.is_fixed = false;
  const auto along = [&](double a, double b, std::size_t m) {
    const double angle = kTurn * angle_deg[m] / kFullTurn_deg;
    return a * std::cos(angle) + b * std::sin(angle);
  };
  return {std::move(motion), combined(without_mean(x.with_drift), without_mean(y.with_drift), along),
          combined(without_mean(x.steady), without_mean(y.steady), along)};
}

}  // namespace

double largest_range_of_noise(std::size_t draws, std::size_t places) {
  constexpr double kStep = 0.05, kFurthest = 9.0, kWidest = 18.0;
  const auto count = static_cast<std::size_t>(2.0 * kFurthest / kStep),
             ranges = static_cast<std::size_t>(kWidest / kStep);
  std::vector<double> below(count + ranges);  // the normal distribution
  for (std::size_t i = 0; i < below.size(); ++i)
    below[i] = 0.5 * std::erfc((kFurthest - kStep * static_cast<double>(i)) / std::numbers::sqrt2);
  // E = ∫ 1 − F(w)^places dw, F(w) = n ∫ φ(x)·(Φ(x + w) − Φ(x))^(n − 1) dx
  const double n = static_cast<double>(draws);
  double expected = 0.0;
  for (std::size_t w = 0; w < ranges; ++w) {
    double within = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = kStep * static_cast<double>(i) - kFurthest;
      within += n * std::exp(-0.5 * x * x) / std::sqrt(kTurn) * std::pow(below[i + w] - below[i], n - 1.0) * kStep;
    }
    expected += (w == 0 ? 0.5 : 1.0) * kStep * (1.0 - std::pow(std::min(1.0, within), static_cast<double>(places)));
  }
  return expected;
}

SpindleTest spindle_test_of(const SpindleTrace& trace) {
  const double usual = median_of(steps_of(trace.turn));
  const std::size_t turns = whole_turns(trace);
  const std::size_t angles = static_cast<std::size_t>(std::lround(std::min(kMostAngles, 1.0 / usual)));
  std::vector<double> angle_deg;
  for (std::size_t m = 0; m < angles; ++m) {
    const double on_deg = kFullTurn_deg * static_cast<double>(m) / static_cast<double>(angles);
    angle_deg.push_back(folded_deg(trace.falling ? trace.first_deg - on_deg : trace.first_deg + on_deg));
  }
  const UnitNoise noise{largest_range_of_noise(turns, angles),
                        largest_range_of_noise(angles, 1) / std::sqrt(static_cast<double>(turns))};
  SpindleTest test{trace.source, turns, angles, trace.falling, trace.has_origin, trace.speed_rpm, {}, trace.notes};
  const auto add = [&](const RawMotion& raw, std::optional<double> sensor_noise) {
    test.motions.push_back(evaluated(raw, angle_deg, noise, sensor_noise));
  };
  const auto grid = [&](SpindleSensor sensor) { return resampled(trace, trace.of(sensor), turns, angles); };
  using enum SpindleSensor;
  // Both directions and, where there are two, the rotating one.
  const auto add_directions = [&](const SpindleMotion& kind, std::string_view id, std::string_view title,
                                  const auto& turns_of, std::optional<double> sensor_noise) {
    std::vector<RawMotion> fixed;
    for (const bool second : {false, true}) {
      const std::optional<Turns> values = turns_of(second);
      if (!values) continue;
      SpindleMotion motion = kind;
      motion.id = fmt::format("{}_{}", id, second ? 'y' : 'x');
      motion.title = fmt::format("{}, fixed direction {}", title, second ? 'Y' : 'X');
      fixed.push_back(fixed_motion(std::move(motion), *values));
      add(fixed.back(), sensor_noise);
    }
    if (fixed.size() < 2) return;
    SpindleMotion motion = kind;
    motion.id = fmt::format("{}_rotating", id);
    motion.title = fmt::format("{}, rotating direction", title);
    add(rotating_motion(std::move(motion), fixed[0], fixed[1], angle_deg), sensor_noise);
  };
  add_directions(
      {}, "radial", "radial",
      [&](bool second) -> std::optional<Turns> {
        if (trace.of(second ? y : x).empty()) return std::nullopt;
        return grid(second ? y : x);
      },
      trace.noise_um);
  if (!trace.of(z).empty())
    add(fixed_motion({.id = "axial", .title = "axial", .is_radial = false}, grid(z)), trace.noise_um);
  if (trace.planes_mm) {
    const double um_per_m = kMmPerM / *trace.planes_mm;
    const auto tilt = [&](bool second) -> std::optional<Turns> {
      if (trace.of(second ? y2 : x2).empty()) return std::nullopt;
      return combined(grid(second ? y2 : x2), grid(second ? y : x),
                      [&](double far, double near, std::size_t) { return (far - near) * um_per_m; });
    };
    add_directions({.is_tilt = true}, "tilt", "tilt", tilt,
                   trace.noise_um ? std::optional(*trace.noise_um * std::numbers::sqrt2 * um_per_m) : std::nullopt);
  }
  if (turns < kUsualTurns)
    test.notes.push_back(
        fmt::format("{} turns are fewer than {}. The asynchronous value grows with the number of turns: "
                    "state it with the value.",
                    turns, kUsualTurns));
  return test;
}

namespace {

/// A curve over the angles of another, linear between its own.
std::vector<double> at_angles_of(const SpindleMotion& other, const SpindleMotion& motion, bool falling) {
  const double count = static_cast<double>(motion.mean.size());
  std::vector<double> values;
  for (const double angle_deg : other.angle_deg) {
    const double ahead_deg = falling ? motion.angle_deg.front() - angle_deg : angle_deg - motion.angle_deg.front();
    const double place = folded_deg(ahead_deg) / kFullTurn_deg * count;
    const auto low = static_cast<std::size_t>(place);
    values.push_back(std::lerp(motion.mean[low % motion.mean.size()], motion.mean[(low + 1) % motion.mean.size()],
                               place - static_cast<double>(low)));
  }
  return values;
}

}  // namespace

Result<std::vector<SpindleSeparation>> separated(const SpindleTest& first, const SpindleTest& second) {
  const auto refused = [&](std::string message) { return problem_at(second.source, 0, 0, std::move(message)); };
  for (const SpindleTest* test : {&first, &second})
    if (!test->has_origin)
      return problem_at(
          test->source, 0, 0,
          "expected a column angle_deg or index: a reversal compares both recordings at the same angle of "
          "the spindle, and time does not give it");
  if (first.falling != second.falling)
    return refused(fmt::format("expected the direction of rotation of {}, found the other one", first.source));
  std::vector<SpindleSeparation> all;
  for (const SpindleMotion& one : first.motions) {
    if (!one.is_radial || !one.is_fixed || one.is_tilt) continue;
    const auto other = std::ranges::find(second.motions, one.id, &SpindleMotion::id);
    if (other == second.motions.end()) continue;
    SpindleSeparation separation{.id = one.id, .angle_deg = one.angle_deg};
    const std::vector<double> turned = at_angles_of(one, *other, first.falling);
    for (std::size_t m = 0; m < turned.size(); ++m) {
      separation.spindle_um.push_back((one.mean[m] - turned[m]) / 2.0);
      separation.ball_um.push_back((one.mean[m] + turned[m]) / 2.0);
    }
    separation.synchronous_um = range_of(separation.spindle_um);
    separation.synchronous_zone_um = zone_width(separation.spindle_um, one.angle_deg);
    separation.form_um = range_of(separation.ball_um);
    separation.form_zone_um = zone_width(separation.ball_um, one.angle_deg);
    separation.sigma_um = 0.5 * std::hypot(one.asynchronous_rms / std::sqrt(static_cast<double>(first.turns)),
                                           other->asynchronous_rms / std::sqrt(static_cast<double>(second.turns)));
    all.push_back(std::move(separation));
  }
  if (all.empty())
    return refused(fmt::format("expected a radial sensor that {} has too, x_um or y_um, found none", first.source));
  return all;
}

}  // namespace ecs::laser
