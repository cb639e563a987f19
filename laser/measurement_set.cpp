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
                                                        const std::vector<CsvRow>& rows) {
  std::set<std::string, std::less<>> numbers;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (is_known_column(columns[i])) continue;
    const bool all = std::all_of(rows.begin(), rows.end(), [&](const CsvRow& row) {
      return row.fields[i].text.empty() || number_in(row.fields[i].text).has_value();
    });
    if (all) numbers.insert(columns[i]);
  }
  return numbers;
}

Reading reading_in(const CsvRow& row, const std::vector<std::string>& columns,
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

}  // namespace

std::optional<std::string> metadata_value(const MeasurementSet& set, std::string_view key) {
  return metadata_value(set.metadata, key);
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
  Findings findings(file_name);
  auto table = parse_csv_table(text, file_name, kNeededColumns, findings);
  if (!table) return tl::unexpected(table.error());
  MeasurementSet set;
  set.source = file_name;
  set.metadata = std::move(table->metadata);
  set.columns = std::move(table->columns);
  const auto extra_numbers = extra_number_columns(set.columns, table->rows);
  for (const CsvRow& row : table->rows) {
    set.readings.push_back(reading_in(row, set.columns, extra_numbers, findings));
    set.readings.back().row = static_cast<int>(set.readings.size());
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (set.readings.empty())
    return problem_at(file_name, table->header_line, 0, "expected readings below the header, found none");
  set.notes = notes_on(set.columns, set.readings);
  if (table->separator != ',')
    set.notes.push_back(fmt::format("{} between the fields, decimal commas taken as points",
                                    table->separator == ';' ? "semicolons" : "tabs"));
  if (table->encoding != Encoding::utf8)
    set.notes.push_back(fmt::format("not UTF-8: read as {}", name_of(table->encoding)));
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
