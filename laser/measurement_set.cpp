#include "laser/measurement_set.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/column_words.hpp"
#include "laser/csv_columns.hpp"
#include "laser/csv_line.hpp"
#include "laser/findings.hpp"
#include "laser/measurement_checks.hpp"
#include "laser/motion.hpp"
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

/// Limits beyond any machine and any instrument in front of one: 1 km; 10 m of error; 10 rad of it; a thousand turns.
constexpr double kMost_mm = 1e6, kMostError_um = 1e7, kMostError_um_per_m = 1e7, kMost_deg = 360'000.0;

/// What is implausible about a reading; empty: nothing.
std::string implausible_in(const Reading& reading) {
  const auto beyond = [](std::string_view what, double value, double limit, std::string_view unit) {
    return fmt::format("{}: expected at most {:g} {} either way, found {:g}: no machine has that; is the unit right?",
                       what, limit, unit, value);
  };
  const double most = is_rotation(reading.sense) ? kMostError_um_per_m : kMostError_um;
  if (!(std::abs(reading.error) <= most)) return beyond("reading", reading.error, most, unit_of(reading.sense));
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (!(std::abs(reading.position_mm[i]) <= kMost_mm))
      return beyond(kPositionColumns[i], reading.position_mm[i], kMost_mm, "mm");
    if (!(std::abs(reading.angle_deg[i]) <= kMost_deg))
      return beyond(kAngleColumns[i], reading.angle_deg[i], kMost_deg, "deg");
  }
  return {};
}

/// The column that seems to hold the targets of an axis, whose own column is missing: named as a target is, and with
/// more than one value. Empty: none.
std::string meant_for_target(Axis axis, bool rotary, const std::vector<std::string>& columns,
                             const std::vector<Reading>& readings) {
  const std::string letter = lower(std::string(1, letter_of(axis, rotary)));
  const std::string own(target_column(axis, rotary));
  for (const std::string& column : columns) {
    if (is_known_column(column)) continue;
    const auto words = heading_words(column);
    const std::string& first = words.front();
    const bool named = lower(column) == own || first == letter || nearest_word(column, {own}) == own ||
                       std::any_of(words.begin(), words.end(), [](const std::string& word) {
                         return word == "target" || word == "position" || word == "pos" || word == "nominal" ||
                                word == "soll" || word == "sollposition" || word == "p" || word == "coordinate";
                       });
    std::set<double> values;
    for (const Reading& reading : readings)
      if (const auto found = reading.extras.find(column); found != reading.extras.end() && values.size() < 2)
        values.insert(found->second);
    if (named && values.size() > 1) return column;
  }
  return {};
}

/// A moving axis without its column, beside a column that seems to hold its targets.
std::optional<Problem> target_misnamed(const MeasurementSet& set, const std::string& file_name, int header_line) {
  for (const bool rotary : {false, true})
    for (const Axis axis : kAllAxes) {
      const std::string_view own = target_column(axis, rotary);
      const bool moved = std::any_of(set.readings.begin(), set.readings.end(), [&](const Reading& reading) {
        return reading.axis == axis && reading.rotary == rotary;
      });
      if (!moved || std::find(set.columns.begin(), set.columns.end(), own) != set.columns.end()) continue;
      const std::string meant = meant_for_target(axis, rotary, set.columns, set.readings);
      if (!meant.empty())
        return Problem{ProblemKind::bad_input,
                       fmt::format("header: expected a column {}, the target of {}, which moves; found none; is {} "
                                   "meant to be it? Name it {} (in {}), or give {} where the axis stood still",
                                   own, letter_of(axis, rotary), in_quotes(meant), own, target_unit(rotary), own),
                       file_name,
                       header_line,
                       1,
                       {}};
    }
  return std::nullopt;
}

/// Readings below this at every target are rather mm than um: no machine tool is so good.
constexpr double kLeastLargest_um = 0.1;
constexpr std::size_t kLeastToAsk = 3;

std::string note_on_size(const std::vector<Reading>& readings) {
  double largest = 0.0;
  for (const Reading& reading : readings) {
    if (is_rotation(reading.sense)) return {};
    largest = std::max(largest, std::abs(reading.error));
  }
  if (readings.size() < kLeastToAsk || largest == 0.0 || largest >= kLeastLargest_um) return {};
  return fmt::format("all readings are below {:g} um, the largest is {:.3g}: are they in mm? They are taken as um",
                     kLeastLargest_um, largest);
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

std::optional<Problem> implausible(const MeasurementSet& set, const std::string& file_name) {
  Findings findings(file_name);
  for (const Reading& reading : set.readings)
    if (std::string fault = implausible_in(reading); !fault.empty())
      findings.add(reading.line, reading.line > 0 ? 1 : 0, std::move(fault));
  return findings.empty() ? std::nullopt : std::optional(findings.as_problem());
}

namespace {

Result<MeasurementSet> parsed(std::string_view text, const std::string& file_name, bool order_gives_approach) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kNeededColumns, findings));
  MeasurementSet set;
  set.source = file_name;
  set.metadata = std::move(table.metadata);
  set.columns = std::move(table.columns);
  const auto extra_numbers = extra_number_columns(set.columns, table.rows);
  for (const CsvRow& row : table.rows) {
    set.readings.push_back(reading_in(row, set.columns, extra_numbers, findings));
    set.readings.back().row = static_cast<int>(set.readings.size());
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (set.readings.empty())
    return problem_at(file_name, table.header_line, 0, "expected readings below the header, found none");
  if (auto misnamed = target_misnamed(set, file_name, table.header_line)) return tl::unexpected(std::move(*misnamed));
  if (auto refused = implausible(set, file_name)) return tl::unexpected(std::move(*refused));
  if (std::find(set.columns.begin(), set.columns.end(), "approach") == set.columns.end()) {
    if (!order_gives_approach) {
      set.columns.emplace_back("approach");  // written as 0: it was said to be unknown
    } else if (const std::size_t given = take_approach_from_order(set); given > 0) {
      set.notes.push_back(
          fmt::format("no column approach: it is taken from the order of the targets, for {} of {} readings; "
                      "--columns approach=none leaves it unknown",
                      given, set.readings.size()));
    }
  }
  if (std::string note = note_on_size(set.readings); !note.empty()) set.notes.push_back(std::move(note));
  for (std::string& note : notes_on(set.columns, set.readings)) set.notes.push_back(std::move(note));
  if (table.separator != ',')
    set.notes.push_back(fmt::format("{} between the fields, decimal commas taken as points",
                                    table.separator == ';' ? "semicolons" : "tabs"));
  if (table.encoding != Encoding::utf8)
    set.notes.push_back(fmt::format("not UTF-8: read as {}", name_of(table.encoding)));
  return set;
}

}  // namespace

Result<MeasurementSet> parse_measurement_set(std::string_view text, const std::string& file_name) {
  return parsed(text, file_name, true);
}

Result<MeasurementSet> set_with_approach_open(std::string_view text, const std::string& file_name) {
  return parsed(text, file_name, false);
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
  ECS_TRY(text, read_file_of(FileKind::measurements, path));
  auto set = parse_measurement_set(text, path.string());
  if (set)
    if (auto refused = rotary_refused(*set, path.string())) return tl::unexpected(std::move(*refused));
  return set;
}

}  // namespace ecs::laser
