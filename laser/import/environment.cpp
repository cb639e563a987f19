#include "laser/import/environment.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

bool is_condition(std::string_view column) {
  return is_sensor_column(column) || column == "pressure_hPa" || column == "humidity_pct";
}

/// First and last time of the readings; nothing if one has none.
std::optional<std::pair<double, double>> span_of(const MeasurementSet& set) {
  std::optional<std::pair<double, double>> span;
  for (const Reading& reading : set.readings) {
    if (!reading.time_s) return std::nullopt;
    if (!span) span.emplace(*reading.time_s, *reading.time_s);
    span->first = std::min(span->first, *reading.time_s);
    span->second = std::max(span->second, *reading.time_s);
  }
  return span;
}

/// One column of the log with the times of its rows on the clock of the readings.
struct Condition {
  std::string name;
  std::vector<double> times_s;
  std::vector<double> values;
};

double between(const Condition& condition, double time_s) {
  const auto after = std::lower_bound(condition.times_s.begin(), condition.times_s.end(), time_s);
  if (after == condition.times_s.begin()) return condition.values.front();
  if (after == condition.times_s.end()) return condition.values.back();
  const auto i = static_cast<std::size_t>(after - condition.times_s.begin());
  const double share = (time_s - condition.times_s[i - 1]) / (condition.times_s[i] - condition.times_s[i - 1]);
  return condition.values[i - 1] + share * (condition.values[i] - condition.values[i - 1]);
}

bool has_condition(const Reading& reading, const std::string& name) {
  if (name == "pressure_hPa") return reading.pressure_hPa.has_value();
  if (name == "humidity_pct") return reading.humidity_pct.has_value();
  return reading.sensors_degC.contains(name);
}

/// Times of the log's rows on the clock of the readings.
Result<std::vector<double>> times_of(MeasurementSet& set, const EnvironmentSeries& series,
                                     std::optional<double> every_s) {
  const auto span = span_of(set);
  const auto count = static_cast<double>(series.rows.size());
  const bool has_times = std::all_of(series.rows.begin(), series.rows.end(),
                                     [](const EnvironmentRow& row) { return row.time_s.has_value(); });
  if (!span && (has_times || every_s))
    return tl::unexpected(usage(set.source,
                                "environment: the readings have no time (time_s, or date_time in --columns), "
                                "the environment has: they cannot be joined by it"));
  const double begin = span ? span->first : 0.0;
  const double length = span ? span->second - span->first : static_cast<double>(set.readings.size() - 1);
  std::vector<double> times;
  if (!has_times) {
    const double step = every_s.value_or(count > 1.0 ? length / (count - 1.0) : 0.0);
    for (std::size_t i = 0; i < series.rows.size(); ++i) times.push_back(begin + step * static_cast<double>(i));
    set.notes.push_back(every_s ? fmt::format("environment: a row every {:g} s from the first reading on", *every_s)
                                : fmt::format("environment: it has no time; its {} rows are spread evenly over the {}",
                                              series.rows.size(), span ? "time of the readings" : "readings"));
    return times;
  }
  const auto begun = metadata_value(set, kBegun);
  const auto begun_s = begun ? seconds_in(*begun) : std::nullopt;
  const bool by_date = series.has_dates && begun_s;
  const double zero = by_date ? *begun_s : *series.rows.front().time_s - begin;
  for (const EnvironmentRow& row : series.rows) times.push_back(*row.time_s - zero);
  set.notes.push_back(by_date ? "environment: joined by date and time"
                              : "environment: joined by time, taken to begin with the first reading");
  const double before = times.front() - begin, after = begin + length - times.back();
  for (const auto& [missing_s, what] : {std::pair{before, "before it begins"}, {after, "after it ends"}})
    if (missing_s > 0.0)
      set.notes.push_back(
          fmt::format("environment: the readings reach {:.0f} s {}, where its end values hold", missing_s, what));
  return times;
}

std::vector<Condition> conditions_of(const EnvironmentSeries& series, const std::vector<double>& times_s) {
  std::vector<Condition> conditions;
  for (std::size_t c = 0; c < series.columns.size(); ++c) {
    if (!is_condition(series.columns[c])) continue;
    Condition condition{series.columns[c], {}, {}};
    for (std::size_t i = 0; i < series.rows.size(); ++i) {
      if (!series.rows[i].values[c] || (!condition.times_s.empty() && times_s[i] <= condition.times_s.back())) continue;
      condition.times_s.push_back(times_s[i]);
      condition.values.push_back(*series.rows[i].values[c]);
    }
    if (!condition.values.empty()) conditions.push_back(std::move(condition));
  }
  return conditions;
}

}  // namespace

Result<void> join_environment(MeasurementSet& set, const EnvironmentSeries& series, std::optional<double> every_s) {
  if (set.readings.empty() || series.rows.empty()) return {};
  ECS_TRY(times_s, times_of(set, series, every_s));
  const auto conditions = conditions_of(series, times_s);
  std::vector<std::string> joined;
  for (const Condition& condition : conditions) {
    std::size_t given = 0;
    for (std::size_t i = 0; i < set.readings.size(); ++i) {
      Reading& reading = set.readings[i];
      if (has_condition(reading, condition.name)) continue;
      const double value = between(condition, reading.time_s.value_or(static_cast<double>(i)));
      static_cast<void>(set_cell(reading, condition.name, shortest(value)));
      ++given;
    }
    if (given == 0) continue;
    const auto [least, most] = std::minmax_element(condition.values.begin(), condition.values.end());
    joined.push_back(fmt::format("{} {:.6g} ... {:.6g}", condition.name, *least, *most));
    if (!set.columns.empty() && std::find(set.columns.begin(), set.columns.end(), condition.name) == set.columns.end())
      set.columns.push_back(condition.name);
  }
  if (!joined.empty()) set.notes.push_back(fmt::format("environment: {}", fmt::join(joined, ", ")));
  return {};
}

}  // namespace ecs::laser
