// The trace of a spindle from its file: columns and head, turns by angle, by pulses or by speed, and what is refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/units.hpp"
#include "laser/csv_table.hpp"
#include "laser/groups.hpp"
#include "laser/standards/circle.hpp"
#include "modules/standards/spindle.hpp"
#include "modules/standards/spindle_series.hpp"

namespace ecs::laser {
namespace {

constexpr double kWidestStep = 1.0 / static_cast<double>(kLeastReadingsPerTurn);  // turns
constexpr double kLargestReading_um = 1e4;
constexpr double kLargestSpeed_rpm = 1e6;
constexpr double kSecondsPerMinute = 60.0;

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
        "ends at line {}. Rows may be missing; readings are interpolated there.",
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
  /// not stand out. With φ = 2π·turn and a slip of δ·v, v from 0 to 1:
  ///   a·cos(φ + δv) + b·sin(φ + δv) = a·cos φ + b·sin φ + δ·v·(b·cos φ − a·sin φ),
  /// beside waves of 2 to 4 per turn; repeated, of a window that grows, so that δ stays small.
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
    trace_.notes.push_back(
        fmt::format("Speed from the once-per-turn motion of {}: {:.6g} rpm; the file states {:g} rpm.", column,
                    fitted_rpm, *trace_.speed_rpm));
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
      check_range(s, greatest, "maximum", greatest - least);
      check_range(s, least, "minimum", greatest - least);
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
           fmt::format("{}: {} consecutive readings equal the {}, {:g} um: the sensor is beyond its range, or its "
                       "resolution is too coarse. Centre the ball or choose a larger range",
                       kSpindleColumns[sensor], longest, which, extreme));
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

}  // namespace ecs::laser
