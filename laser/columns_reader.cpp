// Tables by a mapping of their columns. Does not live here: the mapping's own syntax (import_columns.cpp), the shape
// of a table (import_table.cpp).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import.hpp"
#include "laser/import_columns.hpp"
#include "laser/import_motion.hpp"
#include "laser/import_time.hpp"

namespace ecs::laser {
namespace {

constexpr double kUmPerMm = 1000.0;

/// "forward3" is forward, run 3; "forward" is run 1.
struct Pass {
  Approach approach = Approach::unknown;
  int run = 1;
};

std::optional<Pass> pass_named(std::string_view field) {
  for (const auto& [word, approach] : {std::pair<std::string_view, Approach>{"forward", Approach::forward},
                                       std::pair<std::string_view, Approach>{"reverse", Approach::reverse}}) {
    if (!field.starts_with(word)) continue;
    const std::string_view number = field.substr(word.size());
    if (number.empty()) return Pass{approach, 1};
    const auto run = integer_in(number);
    if (run && *run >= 1 && *run <= 1'000'000) return Pass{approach, static_cast<int>(*run)};
  }
  return std::nullopt;
}

/// What a field does with its cell.
enum class Role { position, error, own_sense, pass, axis, sense, approach, date_time, other };

struct Field {
  ColumnRule rule;
  Role role = Role::other;
  std::size_t index = 0;  ///< of the column, from 0
};

Role role_of(std::string_view name) {
  if (std::find(kPositionColumns.begin(), kPositionColumns.end(), name) != kPositionColumns.end())
    return Role::position;
  if (name == "reading") return Role::error;
  if (sense_named(name)) return Role::own_sense;
  if (pass_named(name)) return Role::pass;
  if (name == "axis") return Role::axis;
  if (name == "sense") return Role::sense;
  if (name == "approach") return Role::approach;
  return name == "date_time" ? Role::date_time : Role::other;
}

bool is_value(Role role) { return role == Role::error || role == Role::own_sense || role == Role::pass; }

/// The kind of unit that a field may have; nothing: none.
std::optional<UnitKind> kind_of(const Field& field) {
  if (field.role == Role::position) return UnitKind::length;
  if (is_sensor_column(field.rule.field)) return UnitKind::temperature;
  if (field.rule.field == "pressure_hPa") return UnitKind::pressure;
  if (field.rule.field == "time_s") return UnitKind::time;
  return std::nullopt;
}

std::optional<Approach> approach_in(std::string_view cell) {
  static const std::map<std::string, Approach, std::less<>> kWords{
      {"1", Approach::forward},        {"+1", Approach::forward},      {"+", Approach::forward},
      {"f", Approach::forward},        {"fwd", Approach::forward},     {"forward", Approach::forward},
      {"up", Approach::forward},       {"pos", Approach::forward},     {"-1", Approach::reverse},
      {"-", Approach::reverse},        {"r", Approach::reverse},       {"b", Approach::reverse},
      {"rev", Approach::reverse},      {"reverse", Approach::reverse}, {"bwd", Approach::reverse},
      {"backward", Approach::reverse}, {"down", Approach::reverse},    {"neg", Approach::reverse},
      {"0", Approach::unknown},        {"", Approach::unknown}};
  const auto found = kWords.find(lower(cell));
  return found == kWords.end() ? std::nullopt : std::optional(found->second);
}

/// Everything about the table that is the same for all rows.
struct Plan {
  std::vector<Field> fields;
  std::optional<Axis> axis;
  std::optional<Sense> sense;
  TableValues values = TableValues::errors;
  char decimal = '\0';
};

std::optional<double> cell_number(const Plan& plan, std::string_view cell) {
  if (plan.decimal == '.') return number_in(cell);
  return number_or_comma(cell);
}

/// The cell in the unit used inside, before the rule's own factor and offset.
double converted(const ColumnRule& rule, double value) {
  return rule.unit ? value * rule.unit->factor + rule.unit->offset : value;
}

std::string unit_fault(const Field& field, std::string_view shown, bool fits) {
  if (fits) return {};
  return fmt::format("columns: {}: {} is no unit of it", field.rule.field, shown);
}

/// Sets the error of a reading whose axis, sense and position are known; what is wrong, or nothing.
std::string set_error(Reading& reading, const Plan& plan, const Field& field, double cell) {
  const ColumnRule& rule = field.rule;
  const bool angle = is_rotation(reading.sense);
  if (rule.unit)
    if (const std::string fault =
            unit_fault(field, rule.unit->name, rule.unit->kind == (angle ? UnitKind::angle : UnitKind::length));
        !fault.empty())
      return fault;
  if (plan.values == TableValues::actual_positions) {
    if (index_of(reading.axis) != static_cast<std::size_t>(reading.sense))
      return "values are positions: expected a sense along the moving axis";
    reading.error = (converted(rule, cell) * rule.factor + rule.offset - target_mm(reading)) * kUmPerMm;
    return {};
  }
  const double inside = converted(rule, cell) * (rule.unit && !angle ? kUmPerMm : 1.0);
  reading.error = (inside * rule.factor + rule.offset) * (plan.values == TableValues::compensations ? -1.0 : 1.0);
  return {};
}

/// What a field does to the reading all readings of its row begin with.
std::string set_common(Reading& reading, const Plan& plan, const Field& field, std::string_view cell) {
  const auto expected = [&](std::string_view what) {
    return fmt::format("{}: expected {}, found {}", field.rule.field, what, in_quotes(cell));
  };
  if (field.role == Role::axis) {
    const auto axis = cell.size() == 1 ? axis_of(lower(cell) == cell ? static_cast<char>(cell[0] - 'a' + 'A') : cell[0])
                                       : std::nullopt;
    if (!axis) return expected("X, Y or Z");
    reading.axis = *axis;
    return {};
  }
  if (field.role == Role::sense) {
    const auto sense = sense_named(cell);
    if (!sense) return expected("EX, EY, EZ, EA, EB or EC");
    reading.sense = *sense;
    return {};
  }
  if (field.role == Role::approach) {
    const auto approach = approach_in(cell);
    if (!approach) return expected("1, -1, 0, forward or reverse");
    reading.approach = *approach;
    return {};
  }
  if (field.role == Role::date_time) {
    const auto seconds = seconds_in(cell);
    if (!seconds) return expected("a date and time (2024-05-06 09:10:11) or a time of day");
    reading.time_s = *seconds;
    return {};
  }
  if (cell.empty() && field.role == Role::other) return {};
  const auto number = cell_number(plan, cell);
  if (!number && is_known_column(field.rule.field)) return expected("a finite number");
  if (!number) {
    reading.text_extras[field.rule.field] = std::string(cell);
    return {};
  }
  const double value = converted(field.rule, *number) * field.rule.factor + field.rule.offset;
  if (!std::isfinite(value)) return expected("a number that stays finite");
  if (!is_known_column(field.rule.field)) {
    reading.extras[field.rule.field] = value;
    return {};
  }
  return set_cell(reading, field.rule.field, shortest(value));
}

int column_of(std::string_view line, std::string_view cell) { return static_cast<int>(cell.data() - line.data()) + 1; }

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

bool has_role(const std::vector<Field>& fields, Role role) {
  return std::any_of(fields.begin(), fields.end(), [&](const Field& field) { return field.role == role; });
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

Problem usage(std::string message, const std::string& file_name) {
  return {ProblemKind::usage, std::move(message), file_name, 0, 0, {}};
}

std::string plan_fault(const Plan& plan) {
  if (std::none_of(plan.fields.begin(), plan.fields.end(), [](const Field& f) { return is_value(f.role); }))
    return "columns: expected one of reading, EX, EY, EZ, EA, EB, EC, forwardN or reverseN, found none";
  if (!has_role(plan.fields, Role::axis) && !plan.axis)
    return "columns: the table does not say which axis moved: give the axis X, Y or Z, or map its column";
  if (plan.axis && !has_role(plan.fields, Role::axis) && !has_role(plan.fields, Role::date_time) &&
      std::none_of(plan.fields.begin(), plan.fields.end(), [&](const Field& f) {
        return f.rule.field == kPositionColumns[index_of(*plan.axis)] || f.rule.field == "time_s";
      }))
    return fmt::format("columns: expected {} (the target of the moving axis), found none",
                       kPositionColumns[index_of(*plan.axis)]);
  for (const Field& field : plan.fields) {
    if (!field.rule.unit || is_value(field.role)) continue;
    const auto kind = kind_of(field);
    if (const std::string fault = unit_fault(field, field.rule.unit->name, kind && *kind == field.rule.unit->kind);
        !fault.empty())
      return fault;
  }
  return {};
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

void take_motion(MeasurementSet& set, const ColumnMapping& mapping) {
  std::vector<double> targets;
  for (const Reading& reading : set.readings) targets.push_back(target_mm(reading));
  const auto motion = motion_of(targets);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (mapping.motion_approach) set.readings[i].approach = motion[i].approach;
    if (mapping.motion_run) set.readings[i].run = motion[i].run;
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

}  // namespace

Result<MeasurementSet> parse_columns(std::string_view text, const std::string& file_name, const ColumnMapping& mapping,
                                     const ImportOptions& options) {
  Plan plan{fields_of(mapping), options.axis, options.sense, mapping.values, mapping.decimal};
  if (!plan.axis) plan.axis = mapped_axis(plan.fields);
  if (const std::string fault = plan_fault(plan); !fault.empty()) return tl::unexpected(usage(fault, file_name));
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

}  // namespace ecs::laser
