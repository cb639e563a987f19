// Tables by a mapping of their columns.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/format.hpp"
#include "laser/import/import.hpp"
#include "laser/import/motion.hpp"

namespace ecs::laser {
namespace {

/// One row: its readings go to `set`.
void take_row(MeasurementSet& set, const Plan& plan, std::string_view line, int number,
              const std::vector<std::string_view>& cells, Findings& findings) {
  Reading common;
  common.line = number;
  common.axis = plan.axis.value_or(Axis::X);
  bool whole = true;
  const auto bad = [&](const Field& field, const std::string& fault) {
    findings.add(number, field.index < cells.size() ? column_of(line, cells[field.index]) : 0, fault);
    whole = false;
  };
  for (const Field& field : plan.fields) {
    if (field.index >= cells.size()) {
      bad(field,
          fmt::format("{}: expected a column {}, found {} columns", field.rule.field, field.index + 1, cells.size()));
      return;
    }
    if (is_value(field.role)) continue;
    if (const std::string fault = set_common(common, plan, field, cells[field.index]); !fault.empty())
      bad(field, fault);
  }
  const bool has_sense =
      std::any_of(plan.fields.begin(), plan.fields.end(), [](const Field& field) { return field.role == Role::sense; });
  if (!has_sense) common.sense = plan.sense.value_or(static_cast<Sense>(index_of(common.axis)));
  if (!whole) return;
  for (const Field& field : plan.fields) {
    if (!is_value(field.role)) continue;
    const std::string_view cell = cells[field.index];
    if (cell.empty() && field.role != Role::error) continue;
    const auto value = cell_number(plan, cell);
    if (!value) {
      bad(field, fmt::format("{}: expected a finite number, found {}", field.rule.field, in_quotes(cell)));
      continue;
    }
    Reading reading = common;
    if (field.role == Role::own_sense) reading.sense = *sense_named(field.rule.field);
    if (const auto pass = pass_named(field.rule.field); pass && field.role == Role::pass) {
      reading.approach = pass->approach;
      reading.run = pass->run;
    }
    std::string fault = set_error(reading, plan, field, *value);
    if (fault.empty() && !std::isfinite(reading.error))
      fault = field.rule.field + ": expected a number that stays finite";
    if (!fault.empty())
      bad(field, fault);
    else
      set.readings.push_back(std::move(reading));
  }
}

/// The axis of a table that maps one position and nothing that says more.
std::optional<Axis> mapped_axis(const std::vector<Field>& fields) {
  std::optional<Axis> found;
  for (std::size_t i = 0; i < kAxes; ++i)
    for (const Field& field : fields)
      if (field.rule.field == kPositionColumns[i]) {
        if (found) return std::nullopt;
        found = static_cast<Axis>(i);
      }
  return found;
}

Problem wrong_option(std::string message, const std::string& file_name) {
  return {ProblemKind::usage, std::move(message), file_name, 0, 0, {}};
}

std::string near_heading(const std::string& wanted, const std::vector<std::string_view>& headings) {
  std::vector<std::string> names(headings.begin(), headings.end());
  const std::string near = nearest_word(wanted, names);
  return near.empty() ? fmt::format("; there are {}", fmt::join(names, ", ")) : "; is " + in_quotes(near) + " meant?";
}

/// Places of the fields that are given by heading.
void find_headings(std::vector<Field>& fields, const std::vector<std::string_view>& headings, int line,
                   Findings& findings) {
  for (Field& field : fields) {
    if (field.rule.column > 0) continue;
    const auto found = std::find_if(headings.begin(), headings.end(), [&](std::string_view heading) {
      return lower(heading) == lower(trimmed(field.rule.heading));
    });
    if (found == headings.end())
      findings.add(line, 1,
                   fmt::format("{}: expected a heading {}, found none{}", field.rule.field,
                               in_quotes(field.rule.heading), near_heading(field.rule.heading, headings)));
    else
      field.index = static_cast<std::size_t>(found - headings.begin());
  }
}

bool is_comment(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.starts_with('#') || text.starts_with('!') || text.starts_with('%');
}

/// A first row whose mapped cells hold no number at all is a heading.
bool is_heading(const Plan& plan, const std::vector<std::string_view>& cells) {
  return std::none_of(plan.fields.begin(), plan.fields.end(), [&](const Field& field) {
    return field.index < cells.size() && cell_number(plan, cells[field.index]).has_value();
  });
}

char delimiter_of(const ColumnMapping& mapping, std::string_view text) {
  if (mapping.delimiter != '\0') return mapping.delimiter;
  const auto shape = table_shape(text);
  return shape ? shape->delimiter : ',';
}

std::vector<Field> fields_of(const ColumnMapping& mapping) {
  std::vector<Field> fields;
  for (const ColumnRule& rule : mapping.rules)
    fields.push_back({rule, role_of(rule.field), static_cast<std::size_t>(std::max(0, rule.column - 1))});
  return fields;
}

/// Rows, not readings, are stops: one row may hold several readings.
void take_motion(MeasurementSet& set, const ColumnMapping& mapping) {
  std::vector<double> targets;
  std::vector<std::size_t> stop_of;
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    if (i == 0 || set.readings[i].line != set.readings[i - 1].line) targets.push_back(target_mm(set.readings[i]));
    stop_of.push_back(targets.size() - 1);
  }
  const auto motion = motion_of(targets);
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    if (mapping.motion_approach) set.readings[i].approach = motion[stop_of[i]].approach;
    if (mapping.motion_run) set.readings[i].run = motion[stop_of[i]].run;
  }
  set.notes.push_back("approach and run from the order of the targets, as asked");
}

/// Readings of the same line, target and approach are runs one after the other.
void number_runs(MeasurementSet& set) {
  std::map<std::tuple<Axis, Sense, Vector3, Approach>, int> seen;
  bool repeated = false;
  for (Reading& reading : set.readings) {
    reading.run = ++seen[{reading.axis, reading.sense, reading.position_mm, reading.approach}];
    repeated = repeated || reading.run > 1;
  }
  if (repeated) set.notes.push_back("no column for the run: repeats at a target are numbered in their order");
}

void begin_at_zero(MeasurementSet& set) {
  std::optional<double> first;
  for (const Reading& reading : set.readings)
    if (reading.time_s) first = std::min(first.value_or(*reading.time_s), *reading.time_s);
  for (Reading& reading : set.readings)
    if (reading.time_s) *reading.time_s -= *first;
}

void finish(MeasurementSet& set, const ColumnMapping& mapping, const Plan& plan) {
  const bool has_run = std::any_of(plan.fields.begin(), plan.fields.end(), [](const Field& field) {
    return field.rule.field == "run" || field.role == Role::pass || field.rule.field == "time_s" ||
           field.role == Role::date_time;
  });
  if (mapping.motion_approach || mapping.motion_run) take_motion(set, mapping);
  if (!has_run && !mapping.motion_run) number_runs(set);
  if (has_role(plan.fields, Role::date_time)) begin_at_zero(set);
  if (mapping.values == TableValues::actual_positions)
    set.notes.push_back("values are positions: error = position - target");
  if (mapping.values == TableValues::compensations) set.notes.push_back("values are compensations: error = -value");
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].row = static_cast<int>(i) + 1;
}

/// Reads the table. The moving axis: column `axis`, the option, or the one position that is mapped; the sense: the
/// field's name (EX …), column `sense`, the option, or the moving axis's own. A row gives a reading for each of
/// `reading`, EX … EC, forwardN and reverseN that is mapped and not empty. Lines beginning with '#', '!' or '%' are
/// comments. Every bad row is reported with line and column.
/// @pre options.mapping
Result<MeasurementSet> read_columns(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  const ColumnMapping& mapping = *options.mapping;
  Plan plan{fields_of(mapping), options.axis, options.sense, mapping.values, mapping.decimal};
  if (!plan.axis) plan.axis = mapped_axis(plan.fields);
  if (const std::string fault = plan_fault(plan); !fault.empty()) return tl::unexpected(wrong_option(fault, file_name));
  const char delimiter = delimiter_of(mapping, text);
  const bool by_heading =
      std::any_of(plan.fields.begin(), plan.fields.end(), [](const Field& f) { return f.rule.column == 0; });
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  const auto lines = lines_of(text);
  bool begun = false;
  int rows = 0;
  for (auto i = static_cast<std::size_t>(std::max(0, mapping.skip_lines)); i < lines.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    if (is_comment(lines[i])) continue;
    if (mapping.most_rows > 0 && rows == mapping.most_rows) break;
    const auto cells = cells_of(lines[i], delimiter);
    if (!begun) {
      begun = true;
      if (by_heading) find_headings(plan.fields, cells, number, findings);
      if (!findings.empty()) break;
      if (by_heading || is_heading(plan, cells)) continue;
    }
    ++rows;
    take_row(set, plan, lines[i], number, cells, findings);
  }
  if (findings.empty() && set.readings.empty())
    findings.add(0, 0, fmt::format("expected rows after line {}, found none", std::max(0, mapping.skip_lines)));
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  for (Reading& reading : set.readings)
    for (std::size_t k = 0; k < kAxes; ++k) {
      const bool mapped = std::any_of(plan.fields.begin(), plan.fields.end(),
                                      [&](const Field& field) { return field.rule.field == kPositionColumns[k]; });
      if (!mapped && k != index_of(reading.axis)) reading.position_mm[k] = options.parked_mm[k];
    }
  finish(set, mapping, plan);
  return set;
}

}  // namespace

extern const FileFormat kMappedColumns{
    .id = "mapped_columns",
    .title = "table by a mapping of columns",
    .sample = "gauge.txt",
    .read = read_columns,
    .units = ErrorUnits::fixed,
};

}  // namespace ecs::laser
