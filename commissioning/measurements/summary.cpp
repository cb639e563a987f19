#include "commissioning/measurements/summary.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

namespace ecs::commissioning {
namespace {

std::optional<double> common_step_mm(const std::vector<laser::TargetReadings>& targets, double tolerance_mm) {
  if (targets.size() < 2) return std::nullopt;
  const double step_mm =
      (targets.back().position_mm - targets.front().position_mm) / static_cast<double>(targets.size() - 1);
  for (std::size_t i = 1; i < targets.size(); ++i)
    if (std::abs(targets[i].position_mm - targets[i - 1].position_mm - step_mm) > 2.0 * tolerance_mm)
      return std::nullopt;
  return step_mm;
}

LineSummary summary_of(const laser::MeasurementSet& set, const laser::Group& group) {
  LineSummary line;
  line.group = group;
  line.readings = group.readings.size();
  std::set<int> runs;
  for (const std::size_t i : group.readings) {
    runs.insert(set.readings[i].run);
    line.forward = line.forward || set.readings[i].approach == Approach::forward;
    line.reverse = line.reverse || set.readings[i].approach == Approach::reverse;
  }
  line.runs = runs.size();
  const double tolerance_mm = laser::target_tolerance_mm(set, group);
  const auto targets = laser::targets_of(set, group, tolerance_mm);
  line.targets = targets.size();
  if (!targets.empty()) {
    line.first_mm = targets.front().position_mm;
    line.last_mm = targets.back().position_mm;
  }
  line.step_mm = common_step_mm(targets, tolerance_mm);
  return line;
}

void take(std::vector<ConditionSummary>& all, const std::string& name, const std::optional<double>& value) {
  if (!value) return;
  auto found = std::find_if(all.begin(), all.end(), [&](const ConditionSummary& c) { return c.name == name; });
  if (found == all.end()) found = all.insert(all.end(), {name, 0, *value, *value});
  ++found->readings;
  found->least = std::min(found->least, *value);
  found->most = std::max(found->most, *value);
}

}  // namespace

std::vector<LineSummary> lines_in(const laser::MeasurementSet& set) {
  std::vector<LineSummary> lines;
  for (const laser::Group& group : laser::groups_of(set)) lines.push_back(summary_of(set, group));
  return lines;
}

std::string parked_text(const laser::Group& group) {
  std::string text;
  for (const Axis a : kAllAxes)
    if (a != group.axis || group.rotary)
      text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", letter_of(a), group.parked_mm[index_of(a)]);
  return text;
}

std::string_view compensated_text(const laser::Group& group) {
  if (!group.compensated) return "?";
  return *group.compensated ? "yes" : "no";
}

std::vector<ConditionSummary> conditions_in(const laser::MeasurementSet& set) {
  std::vector<ConditionSummary> all;
  for (const laser::Reading& reading : set.readings) {
    take(all, "time_s", reading.time_s);
    take(all, "feed_mm_min", reading.feed_mm_min);
    take(all, "load_kg", reading.load_kg);
    take(all, "travel_since_reversal_mm", reading.travel_since_reversal_mm);
    take(all, "pressure_hPa", reading.pressure_hPa);
    take(all, "humidity_pct", reading.humidity_pct);
    for (const auto& [name, value] : reading.sensors_degC) take(all, name, value);
    for (const auto& [name, value] : reading.extras) take(all, name, value);
  }
  return all;
}

std::vector<ConditionSummary> conditions_in(const laser::EnvironmentSeries& series) {
  std::vector<ConditionSummary> all;
  for (const laser::EnvironmentRow& row : series.rows) {
    take(all, "time_s", row.time_s);
    for (std::size_t i = 0; i < series.columns.size(); ++i) take(all, series.columns[i], row.values[i]);
  }
  return all;
}

}  // namespace ecs::commissioning
