// The mapping of columns as users type it, and tables read by it.
#include "laser/import/columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/channels.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/format.hpp"
#include "laser/import/import.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/rows.hpp"
#include "laser/import/set_up.hpp"

namespace ecs::laser {
namespace {

constexpr std::string_view kForm = "FIELD=COLUMN, FIELD=COLUMN[unit] or FIELD=COLUMN*factor, as in x_mm=1[in]";

/// Cut at commas outside double quotes and brackets.
std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && text[i] == '"') quoted = !quoted;
    if (i < text.size() && (quoted || text[i] != ',')) continue;
    parts.push_back(trimmed(text.substr(start, i - start)));
    start = i + 1;
  }
  return parts;
}

/// Takes "[unit]" from the front of `rest`; what is wrong with it, or nothing.
std::string take_unit(ColumnRule& rule, std::string_view& rest) {
  if (!rest.starts_with('[')) return {};
  const std::size_t end = rest.find(']');
  const std::string_view name = trimmed(rest.substr(1, end == std::string_view::npos ? end : end - 1));
  rule.unit = unit_named(name);
  if (end == std::string_view::npos || !rule.unit)
    return fmt::format("expected a unit in brackets ({}), found {}", unit_names(), in_quotes(name));
  rest = trimmed(rest.substr(end + 1));
  return {};
}

/// Takes "*factor" and "+offset" or "-offset".
std::string take_scale(ColumnRule& rule, std::string_view rest) {
  const std::string found = std::string(rest);
  rule.is_scaled = !rest.empty();
  if (rest.starts_with('*')) {
    rest = trimmed(rest.substr(1));
    std::size_t end = rest.find_first_of("+-", 1);
    while (end != std::string_view::npos && (rest[end - 1] == 'e' || rest[end - 1] == 'E'))
      end = rest.find_first_of("+-", end + 1);
    const auto factor = number_in(rest.substr(0, end));
    if (!factor) return "expected a number after *, found " + in_quotes(rest);
    rule.factor = *factor;
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end);
  }
  if (rest.empty()) return {};
  std::string plain;
  for (const char c : rest)
    if (c != ' ') plain += c;
  const auto offset = plain.front() == '+' || plain.front() == '-' ? number_in(plain) : std::nullopt;
  if (!offset) return "expected *factor, +offset or -offset after the column, found " + in_quotes(found);
  rule.offset = *offset;
  return {};
}

/// A column number from the front of `rest`; 0: there is none.
int take_number(std::string_view& rest) {
  const std::size_t end = std::min(rest.find_first_not_of("0123456789"), rest.size());
  const auto number = integer_in(rest.substr(0, end));
  if (!number || *number < 1 || *number > 10'000) return 0;
  rest.remove_prefix(end);
  return static_cast<int>(*number);
}

/// Takes a column number or a range of them, a quoted heading or a plain one from the front.
std::string take_column(ColumnRule& rule, std::string_view& rest) {
  std::size_t end = 0;
  if (rest.starts_with('"')) {
    end = rest.find('"', 1);
    if (end == std::string_view::npos) return "expected a closing double quote after the heading, found none";
    rule.heading = std::string(rest.substr(1, end - 1));
    ++end;
  } else if (!rest.empty() && std::isdigit(static_cast<unsigned char>(rest.front())) != 0) {
    const std::string_view digits = rest.substr(0, rest.find_first_not_of("0123456789"));
    rule.column = take_number(rest);
    if (rule.column == 0) return "expected a column number of 1 to 10000, found " + in_quotes(digits);
    if (rest.starts_with("..")) {
      rest.remove_prefix(2);
      rule.columns = take_number(rest) - rule.column + 1;
      if (rule.columns < 1 || rule.field != "date_time")
        return "expected one column; only date_time accepts several, FIRST..LAST";
    }
  } else {
    end = std::min(rest.find_first_of("[*"), rest.size());
    rule.heading = std::string(trimmed(rest.substr(0, end)));
  }
  if (rule.column == 0 && trimmed(rule.heading).empty()) return "expected a column number or a heading, found nothing";
  rest = trimmed(rest.substr(end));
  return {};
}

std::string rule_fault(ColumnRule& rule, std::string_view part) {
  const std::size_t equals = part.find('=');
  if (equals == std::string_view::npos || equals == 0)
    return fmt::format("expected {}, found {}", kForm, in_quotes(part));
  rule.field = std::string(trimmed(part.substr(0, equals)));
  std::string_view rest = trimmed(part.substr(equals + 1));
  if (std::string fault = take_column(rule, rest); !fault.empty()) return fault;
  if (std::string fault = take_unit(rule, rest); !fault.empty()) return fault;
  return take_scale(rule, rest);
}

bool is_word(const ColumnRule& rule, std::string_view field, std::string_view word) {
  return rule.field == field && rule.column == 0 && rule.heading == word;
}

}  // namespace

Result<std::vector<ColumnRule>> column_rules(std::string_view text) {
  std::vector<ColumnRule> rules;
  std::vector<Problem> problems;
  for (const std::string_view part : parts_of(text)) {
    if (part.empty()) continue;
    ColumnRule rule;
    std::string fault = rule_fault(rule, part);
    const auto same = std::ranges::find_if(rules, [&](const auto& r) { return r.field == rule.field; });
    if (fault.empty() && same != rules.end()) fault = "expected each field once, found it again";
    if (!fault.empty())
      problems.push_back(usage({}, fmt::format("columns: {}: {}", rule.field.empty() ? "rule" : rule.field, fault)));
    rules.push_back(std::move(rule));
  }
  if (rules.empty()) return problem(ProblemKind::usage, "columns: expected {}, found nothing", kForm);
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return rules;
}

std::string rules_text(const std::vector<ColumnRule>& rules) {
  std::string text;
  for (const ColumnRule& rule : rules) {
    std::string column = std::to_string(rule.column);
    if (rule.columns > 1) column += fmt::format("..{}", rule.column + rule.columns - 1);
    if (rule.column == 0) column = is_word_rule(rule) ? rule.heading : '"' + rule.heading + '"';
    text += fmt::format("{}{}={}{}", text.empty() ? "" : ",", rule.field, column,
                        rule.unit ? fmt::format("[{}]", rule.unit->name) : "");
    if (rule.is_scaled) text += "*" + shortest(rule.factor);
    if (rule.offset != 0.0) text += (rule.offset > 0.0 ? "+" : "") + shortest(rule.offset);
  }
  return text;
}

bool is_word_rule(const ColumnRule& rule) {
  return is_word(rule, "approach", "motion") || is_word(rule, "approach", "none") || is_word(rule, "run", "motion") ||
         is_word(rule, "rows", "in_motion");
}

std::optional<std::vector<ColumnRule>> by_number(std::vector<ColumnRule> rules,
                                                 const std::vector<std::string>& headings) {
  for (ColumnRule& rule : rules) {
    if (rule.column > 0 || is_word_rule(rule)) continue;
    const auto found = std::ranges::find_if(
        headings, [&](const std::string& heading) { return lower(heading) == lower(trimmed(rule.heading)); });
    if (found == headings.end()) return std::nullopt;
    rule.column = static_cast<int>(found - headings.begin()) + 1;
    rule.heading.clear();
  }
  return rules;
}

Result<ColumnMapping> column_mapping(std::string_view text) {
  ECS_TRY(rules, column_rules(text));
  ColumnMapping mapping;
  for (ColumnRule& rule : rules) {
    if (is_word(rule, "approach", "motion"))
      mapping.motion_approach = true;
    else if (is_word(rule, "approach", "none"))
      mapping.no_approach = true;
    else if (is_word(rule, "run", "motion"))
      mapping.motion_run = true;
    else
      mapping.rules.push_back(std::move(rule));
  }
  return mapping;
}

namespace {

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
    const auto found = std::ranges::find_if(
        headings, [&](std::string_view heading) { return lower(heading) == lower(trimmed(field.rule.heading)); });
    if (found == headings.end())
      findings.add(line, 1, "{}: expected a heading {}, found none{}", field.rule.field, in_quotes(field.rule.heading),
                   near_heading(field.rule.heading, headings));
    else
      field.index = static_cast<std::size_t>(found - headings.begin());
  }
}

/// A line whose mapped cells hold no number at all is a heading, above the rows or among them.
bool is_heading(const Plan& plan, const std::vector<std::string_view>& cells) {
  return std::ranges::none_of(plan.fields, [&](const Field& field) {
    return field.index < cells.size() && cell_number(plan, cells[field.index]).has_value();
  });
}

char delimiter_of(const ColumnMapping& mapping, std::string_view text) {
  if (mapping.delimiter != '\0') return mapping.delimiter;
  const auto shape = table_shape(text);
  return shape ? shape->delimiter : ',';
}

struct TableLines {
  std::vector<TableRow> rows;
  std::vector<int> passed_over;  ///< lines that do not begin as rows, or hold no numbers
  int comments = 0;              ///< between the rows
  int skipped = 0;               ///< rows above, among the lines to skip
  int left = 0;                  ///< rows below, after those that were wanted
};

/// Every mapped value and position of the line is there, and a number.
bool is_data(const Plan& plan, const std::vector<std::string_view>& cells, std::size_t width) {
  return cells.size() == width && std::ranges::all_of(plan.fields, [&](const Field& field) {
           if (!is_value(field.role) && field.role != Role::position && field.role != Role::target) return true;
           return field.last() < cells.size() && cell_number(plan, cells[field.index]).has_value();
         });
}

/// Takes the lines of a table one after the other.
class LineTaker {
 public:
  LineTaker(Plan& plan, const ImportOptions& options, char delimiter, Findings& findings)
      : plan_(plan),
        options_(options),
        mapping_(*options.mapping),
        delimiter_(delimiter),
        by_heading_(std::ranges::any_of(plan.fields, [](const Field& f) { return f.rule.column == 0; })),
        findings_(findings) {}

  void take(std::string_view line, int number) {
    if (is_comment(line)) {
      if (!trimmed(line).empty() && !table_.rows.empty()) ++comments_;
      return;
    }
    if (const auto target = target_stated(line, options_)) {
      row_.target = target;
      ++row_.block;
      return;
    }
    row_.number = number;
    row_.line = line;
    row_.cells = cells_of(line, delimiter_);
    const bool is_first = !begun_;
    begun_ = true;
    if (is_first && by_heading_) return find_headings(plan_.fields, row_.cells, number, findings_);
    if (mapping_.row_begins.empty() && is_heading(plan_, row_.cells)) {
      if (!is_first) table_.passed_over.push_back(number);
    } else if (begins_as(mapping_.row_begins, row_.cells)) {
      table_.comments += std::exchange(comments_, 0);
      table_.rows.push_back(row_);
    } else {
      table_.passed_over.push_back(number);
    }
  }

  [[nodiscard]] bool is_full() const {
    return mapping_.most_rows > 0 && table_.rows.size() == static_cast<std::size_t>(mapping_.most_rows);
  }
  /// How many of these lines look as the rows do.
  [[nodiscard]] int like_rows(std::span<const std::string_view> lines) const {
    if (table_.rows.empty()) return 0;
    return static_cast<int>(std::ranges::count_if(lines, [&](std::string_view line) {
      return !is_comment(line) && is_data(plan_, cells_of(line, delimiter_), table_.rows.front().cells.size());
    }));
  }
  [[nodiscard]] TableLines& table() { return table_; }

 private:
  Plan& plan_;
  const ImportOptions& options_;
  const ColumnMapping& mapping_;
  char delimiter_;
  bool by_heading_;
  Findings& findings_;
  TableLines table_;
  TableRow row_;
  bool begun_ = false;
  int comments_ = 0;  ///< since the last row
};

/// The rows below the heading, which gives the places of fields by heading.
TableLines lines_in(std::string_view text, Plan& plan, const ImportOptions& options, Findings& findings) {
  const auto lines = lines_of(text);
  const std::size_t first = std::min(static_cast<std::size_t>(std::max(0, options.mapping->skip_lines)), lines.size());
  LineTaker taker(plan, options, delimiter_of(*options.mapping, text), findings);
  std::size_t i = first;
  for (; i < lines.size() && findings.empty() && !taker.is_full(); ++i) taker.take(lines[i], static_cast<int>(i) + 1);
  const std::span<const std::string_view> all(lines);
  taker.table().skipped = taker.like_rows(all.first(first));
  taker.table().left = taker.like_rows(all.subspan(i));
  return std::move(taker.table());
}

/// "3, 7, 12 and 4 more"
std::string numbers_text(const std::vector<int>& numbers) {
  constexpr std::size_t kMost = 8;
  const std::size_t shown = std::min(numbers.size(), kMost);
  const std::vector<int> first(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(shown));
  return fmt::format("{}{}", fmt::join(first, ", "),
                     shown < numbers.size() ? fmt::format(" and {} more", numbers.size() - shown) : "");
}

/// What was in the file and is not in the readings.
void note_left_out(MeasurementSet& set, const ImportOptions& options, const TableLines& table) {
  const ColumnMapping& mapping = *options.mapping;
  const auto note = [&](std::string text) { set.notes.push_back(std::move(text)); };
  if (table.skipped > 0)
    note(fmt::format("{} {} of numbers above line {} {} skipped, as requested", table.skipped,
                     table.skipped == 1 ? "row" : "rows", mapping.skip_lines + 1, table.skipped == 1 ? "is" : "are"));
  if (table.left > 0)
    note(fmt::format("{} rows below line {} are not read, as requested", table.left, table.rows.back().number));
  if (table.comments > 0) note(fmt::format("{} comments between the rows are ignored", table.comments));
  if (!mapping.row_begins.empty() && !table.passed_over.empty())
    note(fmt::format("lines that are not rows are ignored: {}", table.passed_over.size()));
  else if (!table.passed_over.empty())
    note(fmt::format("{} {} no number in the requested columns and {} ignored",
                     (table.passed_over.size() == 1 ? "line " : "lines ") + numbers_text(table.passed_over),
                     table.passed_over.size() == 1 ? "has" : "have", table.passed_over.size() == 1 ? "is" : "are"));
}

/// @param left_out  values that are no numbers
void note_rows(MeasurementSet& set, const ImportOptions& options, const TableLines& table, int left_out) {
  if (options.mapping->target_lines)
    set.notes.push_back(table.rows.back().target
                            ? "lines such as 3mm are the targets: error = value - target"
                            : "no line states a target: readings are the values, not deviations from targets");
  if (options.reading_unit) set.notes.push_back(fmt::format("the readings are in {}", options.reading_unit->name));
  note_left_out(set, options, table);
  if (left_out > 0) set.notes.push_back(fmt::format("{} values that are not numbers are ignored", left_out));
}

/// The unit in which a field's cells are taken where its rule has none.
std::optional<Unit> unit_taken(const Plan& plan, const Field& field) {
  if (field.rule.unit) return field.rule.unit;
  const bool positions = plan.values == TableValues::actual_positions;
  if (field.role == Role::position || field.role == Role::measured) return unit_named("mm");
  if (field.role == Role::target) return unit_named(plan.rotary ? "deg" : "mm");
  if (field.role == Role::angle) return unit_named("deg");
  if (is_value(field.role)) {
    const Sense own = plan.rotary ? Sense::EA : Sense::EX;
    const bool turns = is_rotation(sense_named(field.rule.field).value_or(plan.sense.value_or(own)));
    return unit_named(turns ? (positions ? "deg" : "um/m") : positions ? "mm" : "um");
  }
  if (is_sensor_column(field.rule.field)) return unit_named("degC");
  if (field.rule.field == "pressure_hPa") return unit_named("hPa");
  return field.rule.field == "time_s" ? unit_named("s") : std::nullopt;
}

bool is_same(const Unit& a, const Unit& b) { return a.kind == b.kind && a.factor == b.factor && a.offset == b.offset; }

std::string column_text(const Field& field) {
  return field.rule.column > 0 ? std::to_string(field.rule.column) : fmt::format("\"{}\"", field.rule.heading);
}

/// A mapping whose unit is another than that of the column's heading; a factor says that this is meant.
void refuse_other_units(const Plan& plan, const std::vector<std::string>& headings, int line, Findings& findings) {
  for (const Field& field : plan.fields) {
    if (field.rule.is_scaled || field.index >= headings.size()) continue;
    const auto stated = unit_in_heading(headings[field.index]);
    const auto taken = unit_taken(plan, field);
    if (!stated || !taken || is_same(*stated, *taken)) continue;
    const bool could_be = stated->kind == taken->kind || is_value(field.role);
    findings.add(
        line, 1,
        "{}: the heading of column {}, {}, states {}, but the mapping uses {}: {}{}={}[{}]*1 if the heading is wrong",
        field.rule.field, field.index + 1, in_quotes(headings[field.index]), stated->name, taken->name,
        could_be ? fmt::format("give {}={}[{}], or ", field.rule.field, column_text(field), stated->name)
                 : "give another column, or ",
        field.rule.field, column_text(field), taken->name);
  }
}

/// Errors so small that they are rather mm than um, where neither the heading nor a factor says what they are.
void refuse_tiny(const MeasurementSet& set, const Plan& plan, const std::vector<std::string>& headings, int line,
                 Findings& findings) {
  constexpr double kLeastLargest_um = 0.1;  // no machine tool is so good at every target
  constexpr std::size_t kLeast = 3;
  double largest = 0.0;
  for (const Reading& reading : set.readings)
    largest = std::max(largest, is_rotation(reading.sense) ? kLeastLargest_um : std::abs(reading.error));
  if (plan.values == TableValues::actual_positions || set.readings.size() < kLeast || largest == 0.0 ||
      largest >= kLeastLargest_um)
    return;
  const auto um = unit_named("um");
  for (const Field& field : plan.fields) {
    if (!is_value(field.role) || field.role == Role::measured) continue;
    const auto taken = unit_taken(plan, field);
    const bool stated = field.index < headings.size() && unit_in_heading(headings[field.index]);
    if (field.rule.is_scaled || stated || !taken || !is_same(*taken, *um)) return;
    findings.add(line, 1,
                 "{0}: all readings are below {1:g} um, the largest is {2:.3g}: are they in mm? Give "
                 "{0}={3}[mm], or {0}={3}[um]*1 if they are um",
                 field.rule.field, kLeastLargest_um, largest, column_text(field));
    return;
  }
}

/// The rows of a log by channel.
ChannelLog channels_in(const Plan& plan, const ColumnMapping& mapping, const TableLines& table, Findings& findings) {
  ChannelLog log;
  const auto named = static_cast<std::size_t>(mapping.channel_column - 1);
  for (const TableRow& row : table.rows) {
    Reading when;
    std::optional<double> value;
    for (const Field& field : plan.fields) {
      if (std::max(field.last(), named) >= row.cells.size()) {
        findings.add(row.number, 1, "expected {} columns, found {}", field.last() + 1, row.cells.size());
        return log;
      }
      if (is_value(field.role))
        value = cell_number(plan, row.cells[field.index]);
      else if (const std::string fault = set_common(when, plan, field, joined_cells(row.cells, field)); !fault.empty())
        findings.add(row.number, column_of(row.line, row.cells[field.index]), fault);
    }
    if (value && when.time_s)
      log.channels[std::string(row.cells[named])].push_back({*when.time_s, *value, row.number});
    else
      ++log.left_out;
  }
  return log;
}

/// Reads the table. The moving axis: column `axis`, the option, or the one position that is mapped; the sense: the
/// field's name (EX …), column `sense`, the option, or the moving axis's own. A row gives a reading for each of
/// `reading`, EX … EC, forwardN and reverseN that is mapped and not empty. Lines beginning with '#', '!' or '%' are
/// comments. Every bad row is reported with line and column.
/// @pre options.mapping
Result<MeasurementSet> read_columns(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  ColumnMapping mapping = *options.mapping;
  const bool in_motion =
      std::erase_if(mapping.rules, [](const ColumnRule& rule) { return is_word(rule, "rows", "in_motion"); }) > 0;
  Plan plan{fields_of(mapping.rules),
            options.axis,
            options.rotary,
            options.sense,
            mapping.values,
            mapping.decimal,
            options.parked_mm,
            options.parked_stated,
            !mapping.row_begins.empty()};
  take_mapped_axis(plan);
  Findings findings(file_name);
  TableLines table = lines_in(text, plan, options, findings);
  if (options.channels) {
    if (mapping.channel_column == 0)
      return tl::unexpected(usage(file_name, "channels: the rows of this table have no channel names"));
    ChannelLog log = channels_in(plan, mapping, table, findings);
    if (!findings.empty()) return tl::unexpected(findings.as_problem());
    return read_channels(std::move(log), file_name, options);
  }
  ECS_TRY(channel, keep_channel(table.rows, file_name, options));
  std::string fault = take_units(plan, options);
  if (fault.empty()) fault = plan_fault(plan);
  if (!fault.empty()) return tl::unexpected(usage(file_name, fault));
  std::vector<std::string> headings;
  if (!table.rows.empty() && mapping.row_begins.empty())
    headings = headings_above(lines_of(text), static_cast<std::size_t>(table.rows.front().number - 1),
                              delimiter_of(mapping, text), table.rows.front().cells.size());
  const int heading_line = table.rows.empty() ? 0 : std::max(1, table.rows.front().number - 1);
  refuse_other_units(plan, headings, heading_line, findings);
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
                 left_out > 0 ? "expected numbers, found none"
                 : mapping.skip_lines > 0
                     ? fmt::format("no row below line {} has the columns that were asked for", mapping.skip_lines)
                     : "no row has the columns that were asked for: check their numbers and --delimiter");
  if (findings.empty()) refuse_tiny(set, plan, headings, table.rows.front().number, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (!channel.empty()) set.metadata.push_back({"channel", channel});
  note_rows(set, options, table, left_out);
  finish(set, mapping, plan);
  if (in_motion)
    keep_in_motion(set);
  else if (!options.at_rest_mm && !options.average)
    take_speed(set, kIntervalOfScan_s);
  if (set.readings.empty())
    return problem_at(file_name, 0, 0, "expected readings during motion, found none: leave rows=in_motion out");
  return set;
}

}  // namespace

extern const FileFormat kMappedColumns{
    .id = "mapped_columns",
    .title = "table of columns",
    .sample = "gauge.txt",
    .read = read_columns,
    .units = ErrorUnits::fixed,
};

}  // namespace ecs::laser
