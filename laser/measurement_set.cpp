#include "laser/measurement_set.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/csv_line.hpp"
#include "laser/findings.hpp"
#include "laser/text_decoding.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

struct Row {
  int line = 0;
  std::vector<CsvField> fields;
};

MetadataEntry metadata_in(std::string_view line) {
  const std::string_view text = trimmed(line.substr(1));
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {"", std::string(text)};
  return {std::string(trimmed(text.substr(0, colon))), std::string(trimmed(text.substr(colon + 1)))};
}

/// Of the header row: a comma where it has one, else a semicolon or a tab.
char separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t'})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ',';
}

/// The fields of a line. Where commas do not separate, "1,5" is the number 1.5.
CsvLine fields_of(std::string_view text, char separator) {
  CsvLine line = csv_fields(text, separator);
  if (separator == ',') return line;
  for (CsvField& field : line.fields)
    if (const auto number = number_or_comma(field.text); number && !number_in(field.text))
      field.text = shortest(*number);
  return line;
}

std::vector<std::string> columns_in(const CsvLine& header, int line, Findings& findings) {
  std::vector<std::string> columns;
  for (const CsvField& field : header.fields) {
    if (field.text.empty())
      findings.add(line, field.column, "header: expected a column name, found nothing");
    else if (std::find(columns.begin(), columns.end(), field.text) != columns.end())
      findings.add(line, field.column,
                   fmt::format("header: expected each column once, found {} again", in_quotes(field.text)));
    columns.push_back(field.text);
  }
  for (const std::string_view needed : kNeededColumns) {
    if (std::find(columns.begin(), columns.end(), needed) != columns.end()) continue;
    const std::string near = nearest_word(needed, columns);
    findings.add(line, 1,
                 fmt::format("header: expected a column {}, found none{}", needed,
                             near.empty() ? "" : fmt::format("; is {} meant to be it?", in_quotes(near))));
  }
  return columns;
}

std::vector<std::string> notes_on(const std::vector<std::string>& columns, const std::vector<Reading>& readings) {
  std::vector<std::string> known;
  for (const auto& column : kNumberColumns) known.emplace_back(column.name);
  known.insert(known.end(), kPositionColumns.begin(), kPositionColumns.end());
  known.insert(known.end(), kAngleColumns.begin(), kAngleColumns.end());
  known.insert(known.end(), kOtherColumns.begin(), kOtherColumns.end());
  std::vector<std::string> notes;
  for (const std::string& column : columns) {
    const std::string near = is_known_column(column) ? "" : nearest_word(column, known);
    if (!near.empty() && std::find(columns.begin(), columns.end(), near) == columns.end())
      notes.push_back(fmt::format("column {} is kept but has no meaning here: is {} meant?", column, near));
  }
  for (const bool rotary : {false, true})
    for (const Axis axis : kAllAxes) {
      const bool moved = std::any_of(readings.begin(), readings.end(), [&](const Reading& reading) {
        return reading.axis == axis && reading.rotary == rotary;
      });
      const std::string_view column = target_column(axis, rotary);
      if (moved && std::find(columns.begin(), columns.end(), column) == columns.end())
        notes.push_back(fmt::format("{} is moved but there is no column {}: its target is taken as 0 everywhere",
                                    letter_of(axis, rotary), column));
    }
  return notes;
}

/// Columns without a known meaning of which every cell that is not empty is a number.
std::set<std::string, std::less<>> extra_number_columns(const std::vector<std::string>& columns,
                                                        const std::vector<Row>& rows) {
  std::set<std::string, std::less<>> numbers;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (is_known_column(columns[i])) continue;
    const bool all = std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
      return row.fields[i].text.empty() || number_in(row.fields[i].text).has_value();
    });
    if (all) numbers.insert(columns[i]);
  }
  return numbers;
}

Reading reading_in(const Row& row, const std::vector<std::string>& columns,
                   const std::set<std::string, std::less<>>& extra_numbers, Findings& findings) {
  Reading reading;
  reading.line = row.line;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const CsvField& field = row.fields[i];
    if (is_known_column(columns[i])) {
      const std::string fault = set_cell(reading, columns[i], trimmed(field.text));
      if (!fault.empty()) findings.add(row.line, field.column, fault);
    } else if (!field.text.empty() && extra_numbers.contains(columns[i])) {
      reading.extras[columns[i]] = *number_in(field.text);
    } else if (!field.text.empty()) {
      reading.text_extras[columns[i]] = field.text;
    }
  }
  const std::string_view own = target_column(reading.axis, reading.rotary);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i] == own && trimmed(row.fields[i].text).empty())
      findings.add(row.line, row.fields[i].column,
                   fmt::format("{}: expected the target position of the moving axis, found nothing", own));
  return reading;
}

/// Rows of the right length; the others become findings.
std::vector<Row> rows_in(const std::vector<std::string_view>& lines, std::size_t first, std::size_t width,
                         char separator, Findings& findings) {
  std::vector<Row> rows;
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const int line = static_cast<int>(i) + 1;
    CsvLine cut = fields_of(lines[i], separator);
    if (!cut.fault.empty()) {
      findings.add(line, cut.fault_column, cut.fault);
    } else if (trimmed(lines[i]).starts_with('#')) {
      findings.add(line, 1,
                   "expected a row of readings, found a line beginning with #: these belong before the header");
    } else if (cut.fields.size() != width) {
      const std::size_t at = std::min(width, cut.fields.size() - 1);
      findings.add(
          line, cut.fields[at].column,
          fmt::format("expected {} fields as in the header, found {}{}", width, cut.fields.size(),
                      cut.fields.size() > width ? " (a decimal comma? write numbers with a decimal point)" : ""));
    } else {
      rows.push_back({line, std::move(cut.fields)});
    }
  }
  return rows;
}

}  // namespace

std::optional<std::string> metadata_value(const MeasurementSet& set, std::string_view key) {
  for (const MetadataEntry& entry : set.metadata)
    if (entry.key == key) return entry.value;
  return std::nullopt;
}

std::vector<std::string> sensor_names_of(const MeasurementSet& set) {
  std::set<std::string> names;
  for (const Reading& reading : set.readings)
    for (const auto& sensor : reading.sensors_degC) names.insert(sensor.first);
  return {names.begin(), names.end()};
}

bool is_sensor_column(std::string_view name) {
  constexpr std::string_view kBefore = "t_";
  constexpr std::string_view kAfter = "_degC";
  return name.size() > kBefore.size() + kAfter.size() && name.starts_with(kBefore) && name.ends_with(kAfter);
}

Result<MeasurementSet> parse_measurement_set(std::string_view text, const std::string& file_name) {
  const auto whole = decoded(text, file_name);
  if (!whole) return tl::unexpected(whole.error());
  const auto lines = lines_of(whole->text);
  MeasurementSet set;
  set.source = file_name;
  std::size_t next = 0;
  for (; next < lines.size(); ++next) {
    const std::string_view line = trimmed(lines[next]);
    if (!line.empty() && !line.starts_with('#')) break;
    if (!line.empty()) set.metadata.push_back(metadata_in(line));
  }
  if (next == lines.size())
    return problem_at(file_name, 0, 0, "expected a header row and readings, found only comments");
  const int header_line = static_cast<int>(next) + 1;
  const char separator = separator_of(lines[next]);
  const CsvLine header = csv_fields(lines[next], separator);
  if (!header.fault.empty()) return problem_at(file_name, header_line, header.fault_column, header.fault);
  Findings findings(file_name);
  set.columns = columns_in(header, header_line, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  const std::vector<Row> rows = rows_in(lines, next + 1, set.columns.size(), separator, findings);
  const auto extra_numbers = extra_number_columns(set.columns, rows);
  for (const Row& row : rows) {
    set.readings.push_back(reading_in(row, set.columns, extra_numbers, findings));
    set.readings.back().row = static_cast<int>(set.readings.size());
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (set.readings.empty())
    return problem_at(file_name, header_line, 0, "expected readings below the header, found none");
  set.notes = notes_on(set.columns, set.readings);
  if (separator != ',')
    set.notes.push_back(
        fmt::format("{} between the fields, decimal commas taken as points", separator == ';' ? "semicolons" : "tabs"));
  if (whole->encoding != Encoding::utf8)
    set.notes.push_back(fmt::format("not UTF-8: read as {}", name_of(whole->encoding)));
  return set;
}

std::string curve_name(Sense sense, Axis axis, bool rotary) {
  std::string name(ecs::name_of(curve_of(sense, axis)));
  name.back() = letter_of(axis, rotary);
  return name;
}

std::optional<Problem> rotary_refused(const MeasurementSet& set, const std::string& file_name) {
  const auto found =
      std::find_if(set.readings.begin(), set.readings.end(), [](const Reading& reading) { return reading.rotary; });
  if (found == set.readings.end()) return std::nullopt;
  return Problem{
      ProblemKind::bad_input,
      fmt::format("expected readings of linear axes, found the rotary axis {}: the unit and its maps are of linear "
                  "axes; `ecs laser stats` and `ecs model` take it",
                  letter_of(found->axis, true)),
      file_name,
      std::max(1, found->line),
      1,
      {}};
}

Result<MeasurementSet> read_measurement_set(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  auto set = parse_measurement_set(*text, path.string());
  if (set)
    if (auto refused = rotary_refused(*set, path.string())) return tl::unexpected(std::move(*refused));
  return set;
}

}  // namespace ecs::laser
