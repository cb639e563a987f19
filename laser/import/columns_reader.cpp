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
#include "laser/import/readers.hpp"
#include "laser/import/rows.hpp"

namespace ecs::laser {
namespace {

std::string joined_cells(const std::vector<std::string_view>& cells, const Field& field) {
  return fmt::format("{}", fmt::join(cells.begin() + static_cast<std::ptrdiff_t>(field.index),
                                     cells.begin() + static_cast<std::ptrdiff_t>(field.last() + 1), " "));
}

/// One row: its readings go to `set`.
/// @return values that are left out
int take_row(MeasurementSet& set, const Plan& plan, const TableRow& row, int run, Findings& findings) {
  const auto& cells = row.cells;
  Reading common;
  common.line = row.number;
  common.run = run;
  common.axis = plan.axis.value_or(Axis::X);
  common.position_mm = plan.parked_mm;
  bool whole = true;
  const auto bad = [&](const Field& field, const std::string& fault) {
    findings.add(row.number, field.index < cells.size() ? column_of(row.line, cells[field.index]) : 0, fault);
    whole = false;
  };
  for (const Field& field : plan.fields) {
    if (field.last() >= cells.size()) {
      bad(field,
          fmt::format("{}: expected a column {}, found {} columns", field.rule.field, field.last() + 1, cells.size()));
      return 0;
    }
    if (is_value(field.role)) continue;
    if (const std::string fault = set_common(common, plan, field, joined_cells(cells, field)); !fault.empty())
      bad(field, fault);
  }
  if (row.target) common.position_mm[index_of(common.axis)] = row.target->mm;
  const bool has_sense =
      std::any_of(plan.fields.begin(), plan.fields.end(), [](const Field& field) { return field.role == Role::sense; });
  if (!has_sense) common.sense = plan.sense.value_or(static_cast<Sense>(index_of(common.axis)));
  if (!whole) return 0;
  const bool is_difference = row.target && plan.values != TableValues::actual_positions;
  const double from = is_difference ? row.target->number : 0.0;
  int left_out = 0;
  for (const Field& field : plan.fields) {
    if (!is_value(field.role)) continue;
    const std::string_view cell = cells[field.index];
    if (cell.empty() && field.role != Role::error) continue;
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
    if (const auto pass = pass_named(field.rule.field); pass && field.role == Role::pass) {
      reading.approach = pass->approach;
      reading.run = pass->run;
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

struct TableLines {
  std::vector<TableRow> rows;
  int passed_over = 0;  ///< lines that do not begin as rows
};

/// The rows below the heading, which gives the places of fields by heading.
TableLines lines_in(std::string_view text, Plan& plan, const ImportOptions& options, Findings& findings) {
  const ColumnMapping& mapping = *options.mapping;
  const char delimiter = delimiter_of(mapping, text);
  const bool by_heading =
      std::any_of(plan.fields.begin(), plan.fields.end(), [](const Field& f) { return f.rule.column == 0; });
  TableLines table;
  TableRow row;
  bool begun = false;
  const auto lines = lines_of(text);
  for (auto i = static_cast<std::size_t>(std::max(0, mapping.skip_lines)); i < lines.size(); ++i) {
    if (is_comment(lines[i])) continue;
    if (mapping.most_rows > 0 && table.rows.size() == static_cast<std::size_t>(mapping.most_rows)) break;
    if (const auto target = target_stated(lines[i], options)) {
      row.target = target;
      ++row.block;
      continue;
    }
    row.number = static_cast<int>(i) + 1;
    row.line = lines[i];
    row.cells = cells_of(lines[i], delimiter);
    if (!begun && (by_heading || mapping.row_begins.empty())) {
      begun = true;
      if (by_heading) find_headings(plan.fields, row.cells, row.number, findings);
      if (!findings.empty()) break;
      if (by_heading || is_heading(plan, row.cells)) continue;
    }
    if (begins_as(mapping.row_begins, row.cells))
      table.rows.push_back(row);
    else
      ++table.passed_over;
  }
  return table;
}

/// @param left_out  values that are no numbers
void note_rows(MeasurementSet& set, const ImportOptions& options, const TableLines& table, int left_out) {
  if (options.mapping->target_lines)
    set.notes.push_back(table.rows.back().target
                            ? "lines such as 3mm are the targets: error = value - target"
                            : "no line states a target: readings are the values, not deviations from targets");
  if (options.reading_unit) set.notes.push_back(fmt::format("readings taken as {}", options.reading_unit->name));
  if (table.passed_over > 0)
    set.notes.push_back(fmt::format("{} lines that are no rows are passed over", table.passed_over));
  if (left_out > 0) set.notes.push_back(fmt::format("{} values that are no numbers are left out", left_out));
}

/// Reads the table. The moving axis: column `axis`, the option, or the one position that is mapped; the sense: the
/// field's name (EX …), column `sense`, the option, or the moving axis's own. A row gives a reading for each of
/// `reading`, EX … EC, forwardN and reverseN that is mapped and not empty. Lines beginning with '#', '!' or '%' are
/// comments. Every bad row is reported with line and column.
/// @pre options.mapping
Result<MeasurementSet> read_columns(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  const ColumnMapping& mapping = *options.mapping;
  Plan plan{fields_of(mapping),         options.axis, options.sense, mapping.values, mapping.decimal, options.parked_mm,
            !mapping.row_begins.empty()};
  if (!plan.axis) plan.axis = mapped_axis(plan.fields);
  Findings findings(file_name);
  TableLines table = lines_in(text, plan, options, findings);
  const auto channel = keep_channel(table.rows, file_name, options);
  if (!channel) return tl::unexpected(channel.error());
  std::string fault = take_units(plan, options);
  if (fault.empty()) fault = plan_fault(plan);
  if (!fault.empty()) return tl::unexpected(usage(file_name, fault));
  MeasurementSet set;
  set.source = file_name;
  int run = 1, block = 0, left_out = 0;
  for (const TableRow& row : table.rows) {
    if (row.block != block) run = 1;
    block = row.block;
    const std::size_t before = set.readings.size();
    left_out += take_row(set, plan, row, run, findings);
    if (row.target && set.readings.size() > before) ++run;
  }
  if (findings.empty() && set.readings.empty())
    findings.add(0, 0,
                 left_out > 0
                     ? "expected numbers, found none"
                     : fmt::format("expected rows after line {}, found none", std::max(0, mapping.skip_lines)));
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (!channel->empty()) set.metadata.push_back({"channel", *channel});
  note_rows(set, options, table, left_out);
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
