#include "commissioning/measurements/fields.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/answer_table.hpp"

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
  if (!group.compensated) return "not stated";
  return *group.compensated ? "yes" : "no";
}

std::string_view compensation_text(const laser::Group& group) {
  if (!group.compensated) return "compensation not stated";
  return *group.compensated ? "with compensation" : "without compensation";
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

namespace {

/// {"y": -1400.0, "z": 0.0}
Cell parked_cell(const laser::Group& group) {
  Cell parked{Json::object(), parked_text(group)};
  for (const Axis a : kAllAxes)
    if (a != group.axis || group.rotary)
      parked.json[std::string(1, static_cast<char>(letter_of(a) - 'A' + 'a'))] =
          number_or_null(group.parked_mm[index_of(a)]);
  return parked;
}

Cell six_digits(double value) { return {number_or_null(value), fmt::format("{:.6g}", value)}; }

std::string_view approaches_text(const LineSummary& line) {
  if (line.forward && line.reverse) return "both";
  if (line.forward) return "forward";
  return line.reverse ? "reverse" : "unknown";
}

constexpr int kParkedWidth = 16;

/// @param width  of the parked position
Cell line_cell(const LineSummary& line, int width) {
  AnswerFields fields = measured_line_fields(line.group);
  append(fields, "readings"_is(line.readings), "runs"_is(line.runs), "targets"_is(line.targets),
         FieldKey(line.group.rotary ? "from_deg" : "from_mm")(six_digits(line.first_mm)),
         FieldKey(line.group.rotary ? "to_deg" : "to_mm")(six_digits(line.last_mm)),
         FieldKey(line.group.rotary ? "step_deg" : "step_mm")(
             line.step_mm ? six_digits(*line.step_mm) : null_cell(line.targets > 1 ? "varies" : "-")),
         "forward"_is(line.forward), "reverse"_is(line.reverse), "approaches"_shown(approaches_text(line)));
  const std::string unit(laser::target_unit(line.group.rotary));
  return record_cell(fmt::format("{{axis:<4}} {{sense:<5}} {{parked_mm:<{}}} ", width) + "{from_" + unit + ":>8} {to_" +
                         unit + ":>8} {step_" + unit + ":>7} {targets:>7} {runs:>4} {approaches:<8} {compensated}\n",
                     fields);
}

Cell table_cell(const std::vector<LineSummary>& lines, std::size_t most) {
  const bool rotary = !lines.empty() && lines.front().group.rotary;
  const bool mixed =
      std::any_of(lines.begin(), lines.end(), [&](const LineSummary& line) { return line.group.rotary != rotary; });
  const std::string unit = mixed ? "mm,deg" : std::string(laser::target_unit(rotary));
  int width = kParkedWidth;
  for (const LineSummary& line : lines) width = std::max(width, static_cast<int>(parked_text(line.group).size()));
  Cell table{Json::array(), fmt::format("{:<4} {:<5} {:<{}} {:>8} {:>8} {:>7} {:>7} {:>4} {:<8} {}\n", "axis", "sense",
                                        "parked [mm]", width, "from", fmt::format("to [{}]", unit), "step", "targets",
                                        "runs", "approach", "compensated")};
  for (const LineSummary& line : lines) {
    Cell row = line_cell(line, width);
    if (table.json.size() >= most) row.text.clear();
    table.add(row);
  }
  if (lines.size() > most) table.text += fmt::format("and {} more measured lines\n", lines.size() - most);
  return table;
}

/// The first of each key in JSON, all in the text.
Cell metadata_cell(const laser::MeasurementSet& set) {
  Cell cell{Json::object(), {}};
  for (const auto& [key, value] : set.metadata) {
    if (!key.empty() && !cell.json.contains(key)) cell.json[key] = value;
    cell.text += key.empty() ? fmt::format("  {}\n", value) : fmt::format("  {}: {}\n", key, value);
  }
  return cell;
}

}  // namespace

namespace {

/// "EX along X", "EX over C", "angular positioning of C".
std::string measured_words(const laser::Group& group) {
  const char letter = laser::letter_of(group.axis, group.rotary);
  if (!group.rotary) return fmt::format("{} along {}", name_of(group.sense), letter);
  if (is_rotation(group.sense) && direction_of(group.sense) == group.axis)
    return fmt::format("angular positioning of {}", letter);
  return fmt::format("{} over {}", name_of(group.sense), letter);
}

}  // namespace

AnswerFields measured_line_fields(const laser::Group& group) {
  return described("axis"_is(std::string(1, laser::letter_of(group.axis, group.rotary))),
                   "sense"_is(name_of(group.sense)), "measured"_shown(measured_words(group)),
                   "component"_is(laser::curve_name(group.sense, group.axis, group.rotary)),
                   "unit"_is(laser::unit_of(group.sense)), "parked_mm"_is(parked_cell(group)),
                   "compensated"_is(group.compensated ? Json(*group.compensated) : Json(nullptr),
                                    std::string(compensated_text(group))));
}

AnswerFields set_fields(const laser::MeasurementSet& set, std::size_t most_lines) {
  const std::vector<LineSummary> lines = lines_in(set);
  std::set<std::string> axes, senses;
  std::size_t runs = 0, targets = 0;
  for (const LineSummary& line : lines) {
    axes.insert(std::string(1, laser::letter_of(line.group.axis, line.group.rotary)));
    senses.insert(std::string(name_of(line.group.sense)));
    runs = std::max(runs, line.runs);
    targets += line.targets;
  }
  return described("readings"_is(set.readings.size()), "axes"_is(axes), "senses"_is(senses), "runs"_is(runs),
                   "targets"_is(targets), "metadata"_is(metadata_cell(set)),
                   "notes"_is(lines_cell(set.notes, "  note: ")), "lines"_is(table_cell(lines, most_lines)),
                   "sensors"_is(laser::sensor_names_of(set)));
}

Cell conditions_cell(const std::vector<ConditionSummary>& conditions, std::string_view of) {
  return list_cell(conditions, [&](const ConditionSummary& c) {
    return record_cell("  {name:<28} {least:>10} ... {most:<10} in {readings} {of}\n", "name"_is(c.name),
                       "readings"_is(c.readings), "of"_shown(of), "least"_is(c.least, fmt::format("{:.6g}", c.least)),
                       "most"_is(c.most, fmt::format("{:.6g}", c.most)));
  });
}

}  // namespace ecs::commissioning
