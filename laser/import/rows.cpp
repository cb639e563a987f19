#include "laser/import/rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "base/words.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/time.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {
namespace {

constexpr WordTable<CellKind, 5> kCellKinds{{"any", "word", "number", "date", "time"}};

bool is_kind(CellKind kind, std::string_view cell) {
  switch (kind) {
    case CellKind::any:
      return true;
    case CellKind::word:
      return !number_or_comma(cell);
    case CellKind::number:
      return number_or_comma(cell).has_value();
    case CellKind::date:
      return cell.find('-') != std::string_view::npos && seconds_in(std::string(cell) + " 00:00");
    case CellKind::time:
      return seconds_in("2000-01-01 " + std::string(cell)).has_value();
  }
  return false;
}

}  // namespace

Result<std::vector<CellKind>> cell_kinds(std::string_view text) {
  std::vector<CellKind> kinds;
  for (const std::string_view word : cells_of(text, ' ')) {
    const auto kind = kCellKinds.value_of(word);
    if (!kind)
      return problem(ProblemKind::usage,
                     "row_begins: expected any, word, number, date or time for each cell, found " + in_quotes(word));
    kinds.push_back(*kind);
  }
  return kinds;
}

bool begins_as(const std::vector<CellKind>& kinds, const std::vector<std::string_view>& cells) {
  return cells.size() >= kinds.size() && std::equal(kinds.begin(), kinds.end(), cells.begin(), is_kind);
}

std::size_t rows_begun(std::string_view text, const ColumnMapping& mapping) {
  const auto lines = lines_of(text);
  return static_cast<std::size_t>(std::ranges::count_if(
      lines, [&](std::string_view line) { return begins_as(mapping.row_begins, cells_of(line, mapping.delimiter)); }));
}

std::optional<StatedTarget> target_stated(std::string_view line, const ImportOptions& options) {
  const auto& unit = options.mapping->target_lines;
  const std::string plain = lower(trimmed(line));
  if (!unit || !plain.ends_with(lower(unit->name))) return std::nullopt;
  const auto number = number_in(std::string_view(plain).substr(0, plain.size() - unit->name.size()));
  const double mm = number.value_or(0.0) * options.target_unit.value_or(*unit).factor;
  return number && std::isfinite(mm) ? std::optional(StatedTarget{*number, mm}) : std::nullopt;
}

Result<std::string> keep_channel(std::vector<TableRow>& rows, const std::string& file_name,
                                 const ImportOptions& options) {
  if (options.mapping->channel_column == 0 || rows.empty()) return std::string();
  const auto cell = static_cast<std::size_t>(options.mapping->channel_column - 1);
  const auto channel_of = [&](const TableRow& row) { return cell < row.cells.size() ? row.cells[cell] : ""; };
  std::map<std::string_view, std::size_t> channels;
  for (const TableRow& row : rows) ++channels[channel_of(row)];
  const bool only = options.channel.empty() && channels.size() == 1;
  const std::string channel = only ? std::string(channels.begin()->first) : options.channel;
  if (!only && !channels.contains(channel)) {
    std::vector<std::string> names;
    for (const auto& [name, count] : channels)
      names.push_back(fmt::format("{} ({} value{})", name, count, count == 1 ? "" : "s"));
    return tl::unexpected(
        usage(file_name, fmt::format("{}: give one of {}",
                                     channel.empty() ? "the log contains several channels"
                                                     : "no channel " + in_quotes(channel) + " in the log",
                                     fmt::join(names, ", "))));
  }
  std::erase_if(rows, [&](const TableRow& row) { return channel_of(row) != channel; });
  return channel;
}

namespace {

/// Rows, not readings, are stops: one row may hold several readings.
void take_motion(MeasurementSet& set, const ColumnMapping& mapping) {
  std::vector<double> targets;
  std::vector<std::size_t> stop_of;
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    if (i == 0 || set.readings[i].line != set.readings[i - 1].line) targets.push_back(target_of(set.readings[i]));
    stop_of.push_back(targets.size() - 1);
  }
  const auto motion = motion_of(targets);
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    if (mapping.motion_approach) set.readings[i].approach = motion[stop_of[i]].approach;
    if (mapping.motion_run) set.readings[i].run = motion[stop_of[i]].run;
  }
  set.notes.push_back("approach and run were inferred from the order of the targets (approach=motion, run=motion)");
}

/// Readings of the same line, target and approach are runs one after the other. Where the axis never moves, readings
/// one after the other are no runs.
void number_runs(MeasurementSet& set) {
  const auto elsewhere = std::ranges::find_if(set.readings, [&](const Reading& reading) {
    return reading.position_mm != set.readings.front().position_mm ||
           reading.angle_deg != set.readings.front().angle_deg;
  });
  if (elsewhere == set.readings.end()) return;
  std::map<std::tuple<Axis, Sense, Vector3, Vector3, Approach>, int> seen;
  bool repeated = false;
  for (Reading& reading : set.readings) {
    reading.run = ++seen[{reading.axis, reading.sense, reading.position_mm, reading.angle_deg, reading.approach}];
    repeated = repeated || reading.run > 1;
  }
  if (repeated) set.notes.push_back("no column for the run: repeats at a target are numbered in their order");
}

/// Measured positions without nominal ones: the nominal position of a point is the mean of its readings. Of a ball that
/// the control sees at its tool centre point, the tool is off by the opposite (error = actual - target), `x_mm` … are
/// that point (`at_tip`), and the axis that moved is the rotary one whose angle changed.
void compare_with_means(MeasurementSet& set, const Plan& plan) {
  const bool tips = std::ranges::any_of(plan.fields, [](const Field& field) { return is_tip(field.rule.field); });
  if (!has_role(plan.fields, Role::measured) || (!tips && has_role(plan.fields, Role::position))) return;
  using Point = std::pair<double, std::string>;  // its number, or its name
  const auto point_of = [](const Reading& reading) {
    const auto number = reading.extras.find(kPointColumn);
    const auto name = reading.text_extras.find(kPointColumn);
    return Point{number == reading.extras.end() ? 0.0 : number->second,
                 name == reading.text_extras.end() ? std::string() : name->second};
  };
  std::map<Point, std::array<std::pair<double, int>, kAxes>> sums;  // along X, Y, Z [um]
  for (const Reading& reading : set.readings) {
    auto& [sum, count] = sums[point_of(reading)][index_of(direction_of(reading.sense))];
    sum += reading.error;
    ++count;
  }
  Vector3 last_deg = set.readings.empty() ? Vector3{} : set.readings.front().angle_deg;
  std::size_t turned = 0;
  while (tips && std::ranges::none_of(plan.fields,
                                      [&](const Field& field) { return field.rule.field == kAngleColumns[turned]; }))
    ++turned;
  for (Reading& reading : set.readings) {
    const auto& means = sums[point_of(reading)];
    for (std::size_t d = 0; d < kAxes; ++d)
      if (means[d].second > 0) reading.position_mm[d] = means[d].first / means[d].second / kUmPerMm;
    const auto& [sum, count] = means[index_of(direction_of(reading.sense))];
    reading.error -= sum / count;
    if (!tips) continue;
    reading.error = -reading.error;
    reading.extras["at_tip"] = 1.0;
    for (std::size_t a = 0; a < kAxes; ++a)
      if (reading.angle_deg[a] != last_deg[a]) turned = a;
    last_deg = reading.angle_deg;
    reading.axis = kAllAxes[turned];
    reading.rotary = true;
  }
  set.notes.emplace_back(
      tips ? "targets are the mean of the tool centre points at the ball: error = target - point, because "
             "the ball is where the tool is"
           : "the target of each point is the mean of its measured positions: error = position - target");
}

}  // namespace

std::string joined_cells(const std::vector<std::string_view>& cells, const Field& field) {
  return fmt::format("{}", fmt::join(cells.begin() + static_cast<std::ptrdiff_t>(field.index),
                                     cells.begin() + static_cast<std::ptrdiff_t>(field.last() + 1), " "));
}

std::vector<Field> fields_of(const std::vector<ColumnRule>& rules) {
  std::vector<Field> fields;
  for (const ColumnRule& rule : rules)
    fields.push_back({rule, role_of(rule.field), static_cast<std::size_t>(std::max(0, rule.column - 1))});
  return fields;
}

void take_mapped_axis(Plan& plan) {
  for (const bool rotary : {true, false}) {
    std::vector<Axis> found;
    for (const Axis axis : kAllAxes)
      if (std::ranges::any_of(plan.fields,
                              [&](const Field& field) { return field.rule.field == target_column(axis, rotary); }))
        found.push_back(axis);
    if (plan.axis || found.size() != 1) continue;
    plan.axis = found.front();
    plan.rotary = rotary;
  }
}

int take_row(MeasurementSet& set, const Plan& plan, const TableRow& row, int run, Findings& findings) {
  const auto& cells = row.cells;
  Reading common;
  common.line = row.number;
  common.run = run;
  common.axis = plan.axis.value_or(Axis::X);
  common.rotary = plan.rotary;
  common.position_mm = plan.parked_mm;
  bool whole = true;
  const auto bad = [&](const Field& field, const std::string& fault) {
    findings.add(row.number, field.index < cells.size() ? column_of(row.line, cells[field.index]) : 0, fault);
    whole = false;
  };
  const Field* target = nullptr;  // read when the axis is known
  for (const Field& field : plan.fields) {
    if (field.last() >= cells.size()) {
      bad(field,
          fmt::format("{}: expected a column {}, found {} columns", field.rule.field, field.last() + 1, cells.size()));
      return 0;
    }
    if (field.role == Role::target) target = &field;
    if (is_value(field.role) || field.role == Role::target) continue;
    if (const std::string fault = set_common(common, plan, field, joined_cells(cells, field)); !fault.empty())
      bad(field, fault);
  }
  if (target != nullptr)
    if (const std::string fault = set_target(common, plan, *target, cells[target->index]); !fault.empty())
      bad(*target, fault);
  if (row.target) common.position_mm[index_of(common.axis)] = row.target->mm;
  const bool has_sense = std::ranges::any_of(plan.fields, [](const Field& field) { return field.role == Role::sense; });
  if (!has_sense)
    common.sense = plan.sense.value_or(static_cast<Sense>(index_of(common.axis) + (common.rotary ? kAxes : 0)));
  if (!whole) return 0;
  const bool is_difference = row.target && plan.values != TableValues::actual_positions;
  const double from = is_difference ? row.target->number : 0.0;
  int left_out = 0;
  for (const Field& field : plan.fields) {
    if (!is_value(field.role)) continue;
    const std::string_view cell = cells[field.index];
    if (cell.empty() && field.role != Role::error && field.role != Role::measured) continue;
    const auto value = cell_number(plan, cell);
    if (!value && plan.leaves_words) {
      ++left_out;
      continue;
    }
    if (!value) {
      bad(field, fmt::format("{}: expected a finite number, found {}", field.rule.field, in_quotes(cell)));
      continue;
    }
    Reading reading = common;
    if (field.role == Role::own_sense) reading.sense = *sense_named(field.rule.field);
    if (const auto direction = measured_direction(field.rule.field)) {
      reading.sense = static_cast<Sense>(index_of(*direction));
      if (!plan.axis) reading.axis = *direction;
    }
    if (const auto pass = pass_named(field.rule.field); pass && field.role == Role::pass) {
      reading.approach = pass->approach;
      if (pass->run > 0) reading.run = pass->run;
    }
    std::string fault = set_error(reading, plan, field, *value - from);
    if (fault.empty() && !std::isfinite(reading.error))
      fault = field.rule.field + ": expected a number that stays finite";
    if (!fault.empty())
      bad(field, fault);
    else
      set.readings.push_back(std::move(reading));
  }
  return left_out;
}

void begin_at_zero(MeasurementSet& set) {
  std::optional<double> first;
  for (const Reading& reading : set.readings)
    if (reading.time_s) first = std::min(first.value_or(*reading.time_s), *reading.time_s);
  for (Reading& reading : set.readings)
    if (reading.time_s) *reading.time_s -= *first;
  if (first && !date_time_text(*first).empty()) set.metadata.push_back({std::string(kBegun), date_time_text(*first)});
}

void finish(MeasurementSet& set, const ColumnMapping& mapping, const Plan& plan) {
  const bool has_run = std::ranges::any_of(plan.fields, [](const Field& field) {
    const auto pass = pass_named(field.rule.field);
    return field.rule.field == "run" || (pass && pass->run > 0) || field.rule.field == "time_s" ||
           field.role == Role::date_time;
  });
  compare_with_means(set, plan);
  if (mapping.motion_approach || mapping.motion_run) take_motion(set, mapping);
  if (!has_run && !mapping.motion_run) number_runs(set);
  if (has_role(plan.fields, Role::date_time)) begin_at_zero(set);
  if (mapping.values == TableValues::actual_positions)
    set.notes.push_back("values are positions: error = position - target");
  if (mapping.values == TableValues::compensations) set.notes.push_back("values are compensations: error = -value");
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].row = static_cast<int>(i) + 1;
}

}  // namespace ecs::laser
