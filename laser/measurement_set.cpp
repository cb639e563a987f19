#include "laser/measurement_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/text_decoding.hpp"

namespace ecs::laser {
namespace {

constexpr double kSame_mm = 1e-6;

/// Direction of the step to stop `i`: 1, -1, or 0 for none.
int step_to(const std::vector<double>& p, std::size_t i) {
  const double step = p[i] - p[i - 1];
  return std::abs(step) <= kSame_mm ? 0 : step > 0.0 ? 1 : -1;
}

/// For each stop the direction of the next step that is one; 0 where there is none.
std::vector<int> next_steps(const std::vector<double>& p) {
  std::vector<int> next(p.size(), 0);
  for (std::size_t i = p.size() - 1; i-- > 0;) {
    const int step = step_to(p, i + 1);
    next[i] = step != 0 ? step : next[i + 1];
  }
  return next;
}

/// Positions closer than this part of the travel are one stop: encoders read a stop again within less.
constexpr double kSameStop = 1e-5;
/// Targets of a pass follow each other; an axis that turns at more than every second stop moves in no order.
constexpr std::size_t kMovesATurn = 2;

/// Where the axis stood, with the readings taken there.
struct Stop {
  double position = 0.0;
  std::vector<std::size_t> readings;
  int step = 0;  ///< direction of the motion that led here; 0: the first
};

std::vector<Stop> stops_in(const MeasurementSet& set, const std::vector<std::size_t>& readings) {
  const auto position = [&](std::size_t i) { return target_of(set.readings[i]); };
  const auto [least, most] =
      std::ranges::minmax_element(readings, [&](std::size_t a, std::size_t b) { return position(a) < position(b); });
  const double same = std::max(kSame_mm, kSameStop * (position(*most) - position(*least)));
  std::vector<Stop> stops;
  for (const std::size_t i : readings) {
    const double step = stops.empty() ? 0.0 : position(i) - stops.back().position;
    if (stops.empty() || std::abs(step) > same)
      stops.push_back({position(i), {}, step > 0.0 ? 1 : step < 0.0 ? -1 : 0});
    stops.back().readings.push_back(i);
  }
  return stops;
}

bool turns_at(const std::vector<Stop>& stops, std::size_t s) {
  return s > 0 && s + 1 < stops.size() && stops[s + 1].step == -stops[s].step;
}

/// A single step back between two the other way: from where the axis came then is not in the file.
bool is_jump(const std::vector<Stop>& stops, std::size_t s) {
  return s > 1 && turns_at(stops, s - 1) && turns_at(stops, s);
}

/// Readings at a stop where the axis does not turn.
std::size_t usual_count(const std::vector<Stop>& stops) {
  std::vector<std::size_t> counts;
  for (std::size_t s = 0; s < stops.size(); ++s)
    if (!turns_at(stops, s)) counts.push_back(stops[s].readings.size());
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return *middle;
}

/// By reading; empty where the stops go one way, or in no order.
std::map<std::size_t, Approach> approaches_of(const std::vector<Stop>& stops) {
  std::size_t turns = 0;
  for (std::size_t s = 0; s < stops.size(); ++s)
    if (turns_at(stops, s)) ++turns;
  if (turns == 0 || kMovesATurn * turns > stops.size() - 1) return {};
  const std::size_t usual = usual_count(stops);
  std::map<std::size_t, Approach> approaches;
  bool forward = false, reverse = false;
  const auto give = [&](std::size_t reading, int step) {
    approaches[reading] = static_cast<Approach>(step);
    (step > 0 ? forward : reverse) = true;
  };
  for (std::size_t s = 1; s < stops.size(); ++s) {
    if (is_jump(stops, s)) continue;
    const auto& readings = stops[s].readings;
    const bool turns_here = turns_at(stops, s) && !is_jump(stops, s + 1);
    const std::size_t came = turns_here ? std::min(usual, readings.size()) : readings.size();
    for (std::size_t k = 0; k < came; ++k) give(readings[k], stops[s].step);
    if (readings.size() == 2 * usual)
      for (std::size_t k = came; k < readings.size(); ++k) give(readings[k], -stops[s].step);
  }
  if (!forward || !reverse) return {};
  return approaches;
}

bool is_on_path(const Reading& reading) {
  const auto path = reading.text_extras.find("path");
  return path != reading.text_extras.end() &&
         (path->second.starts_with("circle ") || path->second.starts_with("diagonal "));
}

}  // namespace

std::size_t take_approach_from_order(MeasurementSet& set) {
  std::map<std::tuple<Axis, bool, Sense, std::optional<bool>, int>, std::vector<std::size_t>> passes;
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    const Reading& reading = set.readings[i];
    if (!is_on_path(reading))
      passes[{reading.axis, reading.rotary, reading.sense, reading.compensated, reading.run}].push_back(i);
  }
  std::size_t given = 0;
  for (const auto& [pass, readings] : passes)
    for (const auto& [reading, approach] : approaches_of(stops_in(set, readings))) {
      set.readings[reading].approach = approach;
      ++given;
    }
  return given;
}

std::vector<MotionStop> motion_of(const std::vector<double>& positions_mm) {
  std::vector<MotionStop> stops(positions_mm.size());
  if (positions_mm.empty()) return stops;
  const std::vector<int> next = next_steps(positions_mm);
  int direction = next.front();
  int forward = 0;
  int reverse = 0;
  const auto begin_pass = [&] { return direction >= 0 ? ++forward : ++reverse; };
  int run = begin_pass();
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    const int step = i == 0 ? direction : step_to(positions_mm, i);
    const bool turns = step == 0 ? next[i] == -direction && next[i] != 0 : step == -direction;
    const bool jumps = turns && step != 0 && next[i] == direction;  // back to the start of another pass the same way
    if (i > 0 && turns) {
      if (!jumps) direction = -direction;
      run = begin_pass();
    }
    stops[i] = {static_cast<Approach>(direction), run};
  }
  return stops;
}

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
    if (!near.empty() && std::ranges::find(columns, near) == columns.end())
      notes.push_back(fmt::format("column {} is kept but not used: is {} meant?", column, near));
  }
  for (const bool rotary : {false, true})
    for (const Axis axis : kAllAxes) {
      const bool moved = std::ranges::any_of(
          readings, [&](const Reading& reading) { return reading.axis == axis && reading.rotary == rotary; });
      const std::string_view column = target_column(axis, rotary);
      if (moved && std::ranges::find(columns, column) == columns.end())
        notes.push_back(fmt::format("{} moves but there is no column {}: its target is assumed to be 0 everywhere",
                                    letter_of(axis, rotary), column));
    }
  return notes;
}

/// Limits beyond any machine and any instrument in front of one: 1 km; 10 m of error; 10 rad of it; a thousand turns.
constexpr double kMost_mm = 1e6, kMostError_um = 1e7, kMostError_um_per_m = 1e7, kMost_deg = 360'000.0;

/// What is implausible about a reading; empty: nothing.
std::string implausible_in(const Reading& reading) {
  const auto beyond = [](std::string_view what, double value, double limit, std::string_view unit) {
    return fmt::format("{}: expected at most {:g} {} either way, found {:g}: implausibly large. Check the unit", what,
                       limit, unit, value);
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
                       std::ranges::any_of(words, [](const std::string& word) {
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
      const bool moved = std::ranges::any_of(
          set.readings, [&](const Reading& reading) { return reading.axis == axis && reading.rotary == rotary; });
      if (!moved || std::ranges::find(set.columns, own) != set.columns.end()) continue;
      const std::string meant = meant_for_target(axis, rotary, set.columns, set.readings);
      if (!meant.empty())
        return Problem{
            ProblemKind::bad_input,
            fmt::format("header: there is no column {}, the targets of the moving axis {}. If {} contains them, in "
                        "{}, rename it {}",
                        own, letter_of(axis, rotary), in_quotes(meant), target_unit(rotary), own),
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
  return fmt::format("all readings are below {:g} um, the largest is {:.3g}: are they in mm? They are read as um",
                     kLeastLargest_um, largest);
}

/// Column of the standard uncertainty of the reading.
constexpr std::string_view kUncertaintyInFile = "u_um";

/// Columns without a known meaning of which every cell that is not empty is a number.
std::set<std::string, std::less<>> extra_number_columns(const std::vector<std::string>& columns,
                                                        const std::vector<CsvRow>& rows) {
  std::set<std::string, std::less<>> numbers;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (is_known_column(columns[i])) continue;
    const bool all = std::ranges::all_of(rows, [&](const CsvRow& row) {
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
    } else if (columns[i] == kUncertaintyInFile && !field.text.empty()) {
      const auto uncertainty = number_in(field.text);
      if (uncertainty && *uncertainty > 0.0)
        reading.extras[columns[i]] = *uncertainty;
      else
        findings.add(row.line, field.column, "{}: expected a standard uncertainty above 0, found {}", columns[i],
                     in_quotes(field.text));
    } else if (!field.text.empty() && extra_numbers.contains(columns[i])) {
      reading.extras[columns[i]] = *number_in(field.text);
    } else if (!field.text.empty()) {
      reading.text_extras[columns[i]] = field.text;
    }
  }
  const std::string_view own = target_column(reading.axis, reading.rotary);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i] == own && trimmed(row.fields[i].text).empty())
      findings.add(row.line, row.fields[i].column, "{}: expected the target position of the moving axis, found nothing",
                   own);
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
  if (std::ranges::find(set.columns, "approach") == set.columns.end()) {
    if (!order_gives_approach) {
      set.columns.emplace_back("approach");  // written as 0: it was said to be unknown
    } else if (const std::size_t given = take_approach_from_order(set); given > 0) {
      set.notes.push_back(
          fmt::format("no column approach: it is deduced from the order of the targets for {} of {} readings; "
                      "--columns approach=none keeps it unknown",
                      given, set.readings.size()));
    }
  }
  if (std::string note = note_on_size(set.readings); !note.empty()) set.notes.push_back(std::move(note));
  for (std::string& note : notes_on(set.columns, set.readings)) set.notes.push_back(std::move(note));
  if (table.separator != ',')
    set.notes.push_back(fmt::format("{} between the fields, decimal commas read as points",
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

namespace {

/// The column of readings along a path, and how its texts begin (model/data/path.hpp).
constexpr std::string_view kPathColumn = "path";
constexpr std::array<std::string_view, 2> kPaths{"circle ", "diagonal "};

Problem refused_reading(const Reading& reading, const std::string& file_name, std::string message) {
  return {ProblemKind::bad_input, std::move(message), file_name, std::max(1, reading.line), 1, {}};
}

}  // namespace

std::optional<Problem> paths_refused(const MeasurementSet& set, const std::string& file_name) {
  for (const Reading& reading : set.readings) {
    const auto text = reading.text_extras.find(kPathColumn);
    if (text == reading.text_extras.end()) continue;
    if (std::ranges::any_of(kPaths, [&](std::string_view word) { return text->second.starts_with(word); }))
      return refused_reading(reading, file_name,
                             fmt::format("expected readings along single axes, found one on the path {}: use `ecs "
                                         "model`, or `ecs test` with the file of the test",
                                         in_quotes(text->second)));
  }
  return std::nullopt;
}

std::optional<Problem> all_but_lines_refused(const MeasurementSet& set, const std::string& file_name) {
  const auto found = std::ranges::find_if(set.readings, [](const Reading& reading) { return reading.rotary; });
  if (found == set.readings.end()) return paths_refused(set, file_name);
  return refused_reading(*found, file_name,
                         fmt::format("expected readings of linear axes, found the rotary axis {}, which this command "
                                     "does not evaluate; use `ecs laser stats` and `ecs model`",
                                     letter_of(found->axis, true)));
}

Result<MeasurementSet> read_measurement_set(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::measurements, path));
  auto set = parse_measurement_set(text, path.string());
  if (set)
    if (auto refused = all_but_lines_refused(*set, path.string())) return tl::unexpected(std::move(*refused));
  return set;
}

namespace {

/// As a map's header may hold it.
std::string stated_name(const std::string& value) {
  constexpr std::size_t kLongest = 160;
  return cut_line(shown(value), kLongest);
}

}  // namespace

MeasuredMachine measured_machine(const std::vector<MetadataEntry>& metadata) {
  MeasuredMachine machine;
  for (const MetadataEntry& entry : metadata) {
    const std::string key = lower(entry.key);
    if (key == "machine" && machine.name.empty()) machine.name = stated_name(entry.value);
    if ((key == "serial_number" || key == "serial no") && machine.serial_number.empty())
      machine.serial_number = stated_name(entry.value);
  }
  return machine;
}

std::optional<std::string> other_machine(const MeasuredMachine& measured, const MeasuredMachine& at_hand,
                                         std::string_view whose) {
  if (!measured.name.empty() && !at_hand.name.empty() && measured.name != at_hand.name)
    return fmt::format("measured on \"{}\", {} \"{}\"", measured.name, whose, at_hand.name);
  if (!measured.serial_number.empty() && !at_hand.serial_number.empty() &&
      measured.serial_number != at_hand.serial_number)
    return fmt::format("measured on serial number {}, {} serial number {}", measured.serial_number, whose,
                       at_hand.serial_number);
  return std::nullopt;
}

std::optional<std::string> beyond_travel(std::string_view what, Axis axis, const std::array<double, 2>& ends_mm,
                                         const std::array<double, 2>& travel_mm) {
  const double beyond_mm = std::max(travel_mm[0] - ends_mm[0], ends_mm[1] - travel_mm[1]);
  if (beyond_mm <= kUsualMargin * (travel_mm[1] - travel_mm[0])) return std::nullopt;
  return fmt::format(
      "{} was measured from {:.6g} to {:.6g} mm, but {} travels from {:.6g} to {:.6g} mm: do file and machine belong "
      "together?",
      what, ends_mm[0], ends_mm[1], letter_of(axis), travel_mm[0], travel_mm[1]);
}

}  // namespace ecs::laser
