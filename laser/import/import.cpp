// Our own CSV form as a format of the registry. The form itself: laser/measurement_set.hpp.
#include "laser/import/import.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/groups.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/set_up.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

/// Readings, or the records of an environment log.
Result<Imported> content_of(const FileFormat& format, std::string_view text, const std::string& file_name,
                            const ImportOptions& options) {
  if (format.read_environment) {
    ECS_TRY(series, format.read_environment(text, file_name));
    Imported imported{&format, {}, std::move(series)};
    imported.set.source = file_name;
    imported.set.notes = imported.environment.notes;
    return imported;
  }
  ECS_TRY(set, format.read(text, file_name, options));
  return Imported{&format, std::move(set), {}};
}

/// The unit in which a reader took the errors of a file.
double usual_reading_factor(const FileFormat& format, Sense sense) {
  constexpr double kPerMrad = 1000.0;  // and um per mm
  return !is_rotation(sense) && format.holds_um ? 1.0 : kPerMrad;
}

/// Other units than the file's usual ones.
Result<Imported> rescaled(Result<Imported> imported, const ImportOptions& options) {
  if (!imported || (!options.target_unit && !options.reading_unit)) return imported;
  const auto wrong = [&](std::string message) -> Result<Imported> {
    return tl::unexpected(usage(imported->set.source, std::move(message)));
  };
  const FileFormat& format = *imported->format;
  if (format.units == ErrorUnits::fixed) return wrong(fmt::format("{}: its units are fixed", format.title));
  const bool holds_positions = format.units == ErrorUnits::positions;
  if (holds_positions && options.reading_unit)
    return wrong("the file contains positions: give the unit of the targets, which also applies to the readings");
  const UnitKind target_kind = options.rotary ? UnitKind::angle : UnitKind::length;
  if (options.target_unit && options.target_unit->kind != target_kind)
    return wrong(fmt::format("{} is not a unit of {}", options.target_unit->name, options.rotary ? "angle" : "length"));
  for (Reading& reading : imported->set.readings) {
    if (options.target_unit && !options.rotary) {
      reading.position_mm[index_of(reading.axis)] *= options.target_unit->factor;
      if (holds_positions) reading.error *= options.target_unit->factor;
    }
    if (!options.reading_unit) continue;
    const bool angle = is_rotation(reading.sense);
    if (options.reading_unit->kind != (angle ? UnitKind::angle : UnitKind::length))
      return wrong(fmt::format("{} is not a unit of {}", options.reading_unit->name, ecs::name_of(reading.sense)));
    const double inside = options.reading_unit->factor * (angle ? 1.0 : 1000.0);
    reading.error *= inside / usual_reading_factor(format, reading.sense);
  }
  if (options.target_unit) imported->set.notes.push_back(fmt::format("targets read as {}", options.target_unit->name));
  if (options.reading_unit)
    imported->set.notes.push_back(fmt::format("the readings are in {}", options.reading_unit->name));
  return imported;
}

/// Readings of a file that a rotary axis was measured to, whose readers know linear ones: its targets are degrees, or
/// in the unit given.
Result<Imported> turned(Result<Imported> imported, const ImportOptions& options) {
  if (!imported || !options.rotary) return imported;
  const bool holds_positions = imported->format->units == ErrorUnits::positions;
  const double to_deg = options.target_unit ? options.target_unit->factor / kUmPerMPerDegree : 1.0;
  for (Reading& reading : imported->set.readings) {
    if (reading.rotary || reading.axis != *options.axis) continue;
    if (!holds_positions && !is_rotation(reading.sense))
      return tl::unexpected(usage(
          imported->set.source,
          fmt::format("{} contains lengths, and a rotary axis needs angles: give a linear axis, X, Y or Z, or read the "
                      "file as a table (--columns)",
                      imported->format->title)));
    const std::size_t i = index_of(reading.axis);
    const auto about = static_cast<Sense>(kAxes + i);
    if (holds_positions && options.sense.value_or(about) != about)
      return tl::unexpected(
          usage(imported->set.source, fmt::format("the file contains positions of the axis: expected the sense {}, "
                                                  "found {}",
                                                  ecs::name_of(about), ecs::name_of(*options.sense))));
    reading.rotary = true;
    reading.angle_deg[i] = reading.position_mm[i] * to_deg;
    reading.position_mm[i] = options.parked_mm[i];
    if (!holds_positions) continue;
    reading.sense = about;
    reading.error *= to_deg * kUmPerMPerDegree / kUmPerMm;
  }
  imported->set.notes.push_back(
      fmt::format("{} read as {} of the rotary axis {}", holds_positions ? "targets and readings" : "targets",
                  options.target_unit ? options.target_unit->name : "deg", letter_of(*options.axis, true)));
  return imported;
}

/// The first stretch of readings that rise or fall does so in even steps, as targets do, over far more than its
/// positions, which are small and uneven.
bool look_exchanged(const MeasurementSet& set, const Group& group) {
  constexpr std::size_t kFewestSteps = 4;
  constexpr double kEven = 0.5, kUneven = 1.0;  // largest minus smallest step, of their mean size
  constexpr double kLeast_um_per_mm = 20.0;     // no machine has an error of 2 %
  if (group.rotary || is_rotation(group.sense)) return false;
  const std::size_t axis = index_of(group.axis);
  std::vector<double> steps_mm, steps_um;
  double largest_mm = 0.0, travel_um = 0.0;
  for (std::size_t k = 1; k < group.readings.size(); ++k) {
    const Reading &before = set.readings[group.readings[k - 1]], &reading = set.readings[group.readings[k]];
    const double step_um = reading.error - before.error;
    if (step_um == 0.0 || step_um * travel_um < 0.0) break;
    steps_um.push_back(step_um);
    steps_mm.push_back(reading.position_mm[axis] - before.position_mm[axis]);
    travel_um += step_um;
    largest_mm = std::max({largest_mm, std::abs(before.position_mm[axis]), std::abs(reading.position_mm[axis])});
  }
  const auto spread = [](const std::vector<double>& steps) {
    const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
    double size = 0.0;
    for (const double step : steps) size += std::abs(step) / static_cast<double>(steps.size());
    return size > 0.0 ? (*most - *least) / size : 0.0;
  };
  return steps_um.size() >= kFewestSteps && spread(steps_um) < kEven && spread(steps_mm) > kUneven &&
         std::abs(travel_um) > kLeast_um_per_mm * largest_mm;
}

/// Notes lines whose columns of position and reading look exchanged.
void note_exchanged(MeasurementSet& set) {
  for (const Group& group : groups_of(set))
    if (look_exchanged(set, group))
      set.notes.push_back(
          fmt::format("{}: the readings rise or fall in even steps and the positions do not: the columns of position "
                      "and reading appear to be swapped",
                      curve_name(group.sense, group.axis, group.rotary)));
}

/// With the nominal ones beside them.
bool gives_measured_positions(const ImportOptions& options) {
  const auto any = [&](auto is) { return options.mapping && std::ranges::any_of(options.mapping->rules, is); };
  return any([](const ColumnRule& rule) { return measured_direction(rule.field).has_value(); }) &&
         any([](const ColumnRule& rule) { return role_of(rule.field) == Role::position; });
}

/// Axes whose place the columns of a table state.
void take_columns(PerAxis<bool>& known, const std::vector<std::string>& columns) {
  for (const Axis a : kAllAxes)
    if (std::ranges::find(columns, lower(std::string(1, letter_of(a))) + "_mm") != columns.end())
      known[index_of(a)] = true;
}

/// A place that is assumed decides over levers and squareness: a measuring instrument's file has none.
void note_assumed_places(Imported& imported, const ImportOptions& options) {
  if (imported.format->places_in_columns || imported.set.readings.empty()) return;
  const PerAxis<bool> known = places_stated(imported, options);
  std::vector<std::string> axes, example;
  for (const Axis a : kAllAxes) {
    const auto moves = [&](const Reading& one) { return one.axis == a && !one.rotary; };
    if (known[index_of(a)] || options.parked_stated[index_of(a)] || std::ranges::any_of(imported.set.readings, moves))
      continue;
    axes.emplace_back(1, letter_of(a));
    example.push_back(lower(axes.back()) + "=MM");
  }
  if (axes.empty()) return;
  imported.set.notes.push_back(fmt::format("{} {}; 0 is assumed. State it with --parked {}", kPlaceNotStated,
                                           fmt::join(axes, " and "), fmt::join(example, ",")));
}

}  // namespace

PerAxis<bool> places_stated(const Imported& imported, const ImportOptions& options) {
  PerAxis<bool> known = imported.format->states_place;
  if (imported.format->places_in_columns) take_columns(known, imported.set.columns);
  if (!options.mapping) return known;
  std::vector<std::string> fields;
  for (const ColumnRule& rule : options.mapping->rules) fields.push_back(rule.field);
  take_columns(known, fields);
  return known;
}

namespace {

constexpr const char* kSetUpColumn = "set_up";

/// Names of set-ups become their numbers, in the order of the readings.
void number_set_ups(MeasurementSet& set) {
  std::vector<std::string> names;
  for (Reading& reading : set.readings) {
    const auto text = reading.text_extras.find(kSetUpColumn);
    if (text == reading.text_extras.end()) continue;
    const auto found = std::ranges::find(names, text->second);
    reading.extras[kSetUpColumn] = static_cast<double>(found - names.begin() + 1);
    if (found == names.end()) names.push_back(text->second);
    reading.text_extras.erase(text);
  }
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = fmt::format("{} {}", i + 1, in_quotes(names[i]));
  if (!names.empty())
    set.notes.push_back(fmt::format("set-ups are numbered in the order of the readings: {}", fmt::join(names, ", ")));
}

}  // namespace

Result<Imported> parse_any(std::string_view bytes, const std::string& file_name, const ImportOptions& options) {
  const bool is_mapped = options.mapping || options.matrix;
  const FileFormat* binary = is_mapped ? nullptr : recognised_format(bytes, file_name);
  if (binary && binary->is_binary) return rescaled(content_of(*binary, bytes, file_name, options), options);
  ECS_TRY(text, decoded(bytes, file_name, options.encoding));
  const FileFormat* format = options.mapping  ? file_format("mapped_columns")
                             : options.matrix ? file_format("mapped_matrix")
                                              : recognised_format(text.text, file_name);
  if (!format) return tl::unexpected(explanation_of(text.text, file_name));
  auto imported = content_of(*format, text.text, file_name, options);
  if (!is_mapped) imported = turned(rescaled(std::move(imported), options), options);
  if (imported && !options.takes_rotary)
    if (auto refused = all_but_lines_refused(imported->set, file_name)) return tl::unexpected(std::move(*refused));
  if (imported && !options.keep_set_up && gives_measured_positions(options)) take_out_set_up(imported->set);
  if (imported && !imported->set.readings.empty() && (options.at_rest_mm || options.average)) {
    keep_at_rest(imported->set, options.at_rest_mm, options.average);
    if (imported->set.readings.empty())
      return problem_at(file_name, 0, 0,
                        "expected readings at rest, which need three consecutive rows at one position, found none: "
                        "give a larger --at-rest, or omit it");
  }
  if (imported)
    if (auto refused = implausible(imported->set, file_name)) return tl::unexpected(std::move(*refused));
  if (imported) number_set_ups(imported->set);
  if (imported && (options.mapping || imported->format->places_in_columns)) note_exchanged(imported->set);
  if (imported) note_assumed_places(*imported, options);
  if (imported && !options.note.empty()) imported->set.notes.push_back(options.note);
  if (imported && text.encoding != Encoding::utf8)
    imported->set.notes.push_back(fmt::format("not UTF-8: read as {}", name_of(text.encoding)));
  return imported;
}

Result<Imported> imported_from(std::string_view bytes, const std::string& file_name, const ImportOptions& options) {
  if (!options.mapping && !options.matrix)
    if (auto wrong = wrong_kind(FileKind::measurements, bytes, file_name)) return tl::unexpected(std::move(*wrong));
  auto imported = parse_any(bytes, file_name, options);
  if (imported) imported->sha256 = sha256_hex(bytes);
  return imported;
}

Result<Imported> read_any(const std::filesystem::path& path, const ImportOptions& options) {
  ECS_TRY(bytes, read_file(path));
  return imported_from(bytes, path.string(), options);
}

FileReader reading_once(FileReader read) {
  return [read = std::move(read), known = std::make_shared<std::map<std::filesystem::path, Result<Imported>>>()](
             const std::filesystem::path& path) {
    const auto found = known->find(path);
    return found != known->end() ? found->second : known->emplace(path, read(path)).first->second;
  };
}

Result<Axis> axis_wanted(const ImportOptions& options, const std::string& file_name) {
  if (options.axis) return *options.axis;
  return tl::unexpected(usage(
      file_name, "the file does not state which axis moved. Give the axis (X, Y or Z; for a rotary axis A, B or C)"));
}

Result<Sense> positioning_sense(const ImportOptions& options, Axis axis, const std::string& file_name) {
  const auto along = static_cast<Sense>(index_of(axis));
  const Sense sense = options.sense.value_or(along);
  if (!is_rotation(sense)) return sense;
  if (options.rotary) return along;  // becomes an angle afterwards, where that is possible
  return tl::unexpected(
      usage(file_name,
            fmt::format("the file contains lengths: expected the sense EX, EY or EZ, found {}", ecs::name_of(sense))));
}

Result<PositioningLine> positioning_line(const ImportOptions& options, const std::string& file_name) {
  ECS_TRY(axis, axis_wanted(options, file_name));
  ECS_TRY(sense, positioning_sense(options, axis, file_name));
  return PositioningLine{axis, sense};
}

Reading reading_at(const ImportOptions& options, const PositioningLine& at, double position_mm, double error_um,
                   int text_line) {
  Reading reading;
  reading.line = text_line;
  reading.axis = at.axis;
  reading.sense = at.sense;
  reading.position_mm = position_at(options, at.axis, position_mm);
  reading.error = error_um;
  return reading;
}

std::vector<double> numbers_alone(std::string_view text_line) {
  std::vector<double> numbers;
  for (const std::string_view word : blank_words(text_line)) {
    const auto number = number_or_comma(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<std::vector<double>> row_of(std::string_view text_line, std::size_t count) {
  auto numbers = numbers_alone(text_line);
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

Vector3 position_at(const ImportOptions& options, Axis axis, double target_mm) {
  Vector3 position = options.parked_mm;
  position[index_of(axis)] = target_mm;
  return position;
}

void number_rows(MeasurementSet& set) {
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].row = static_cast<int>(i) + 1;
}

extern const FileFormat kMeasurementCsv;
extern const FileFormat kRenishawRun;
extern const FileFormat kRenishawDynamic;
extern const FileFormat kRenishawTable;
extern const FileFormat kApiReport;
extern const FileFormat kSiosEnvironment;
extern const FileFormat kEnvironmentTable;
extern const FileFormat kIso230Assignments;
extern const FileFormat kPlate;
extern const FileFormat kJsonLines;
extern const FileFormat kGuideLog;
extern const FileFormat kMappedColumns;
extern const FileFormat kMappedMatrix;

std::span<const FileFormat* const> file_formats() {
  // clang-format off
  static constexpr std::array kFormats{
      &kMeasurementCsv,
      &kRenishawRun,
      &kRenishawDynamic,
      &kRenishawTable,
      &kApiReport,
      &kSiosEnvironment,
      &kEnvironmentTable,
      &kIso230Assignments,
      &kPlate,
      &kJsonLines,
      &kGuideLog,
      &kMappedColumns,
      &kMappedMatrix,
  };
  // clang-format on
  return kFormats;
}

const FileFormat* file_format(std::string_view id) {
  const auto formats = file_formats();
  const auto at = std::ranges::find_if(formats, [&](const auto* format) { return format->id == id; });
  return at == formats.end() ? nullptr : *at;
}

const FileFormat* recognised_format(std::string_view text, const std::string& file_name) {
  const FileStart file(text, file_name);
  const FileFormat* likely = nullptr;
  for (const FileFormat* format : file_formats()) {
    const Recognition found = format->recognises ? format->recognises(file) : Recognition::no;
    if (found == Recognition::certain) return format;
    if (found == Recognition::likely && !likely) likely = format;
  }
  return likely;
}

const FileFormat& format_written_as(std::string_view extension) {
  for (const FileFormat* format : file_formats()) {
    const auto& own = format->written_extensions;
    if (std::ranges::find(own, lower(extension)) != own.end()) return *format;
  }
  return kMeasurementCsv;
}

FileStart::FileStart(std::string_view whole, std::string_view name) : text(whole), file_name(name) {
  constexpr std::size_t kHeadBytes = 16 * 1024;  // heads and headings are at the start of a file
  head = lower(text.substr(0, kHeadBytes));
  for (const std::string_view line : lines_of(text.substr(0, kHeadBytes)))
    if (first_line.empty() && !trimmed(line).starts_with('#')) first_line = trimmed(line);
}

namespace {

/// A heading with two of the columns that only this form has.
bool is_csv_heading(std::string_view line) {
  std::string plain = lower(line);
  std::replace_if(
      plain.begin(), plain.end(), [](char c) { return c == ';' || c == '\t' || c == '"' || c == ' '; }, ',');
  int known = 0;
  for (const std::string_view word : split(plain, ','))
    if (word == "axis" || word == "sense" || word == "reading" || word == "approach" || word == "x_mm") ++known;
  return known >= 2;
}

/// Row at the end of a file that stops within it.
struct IncompleteRow {
  std::size_t from = 0;  ///< place in the text
  int line = 0;
  std::size_t found = 0, expected = 0;  ///< fields
};

/// Nothing where the last row has its fields, or nothing follows the heading.
std::optional<IncompleteRow> incomplete_last_row(std::string_view text) {
  const auto lines = numbered_lines_of(text);
  const auto is_row = [](const NumberedLine& line) {
    return !trimmed(line.text).empty() && !trimmed(line.text).starts_with('#');
  };
  const auto heading = std::ranges::find_if(lines, is_row);
  if (heading == lines.end()) return std::nullopt;
  const auto last = std::find_if(lines.rbegin(), lines.rend(), is_row);
  if (last->number == heading->number) return std::nullopt;
  const char separator = heading->text.find(',') != std::string_view::npos   ? ','
                         : heading->text.find(';') != std::string_view::npos ? ';'
                                                                             : '\t';
  const std::size_t expected = csv_fields(heading->text, separator).fields.size();
  const std::size_t found = csv_fields(last->text, separator).fields.size();
  if (found >= expected) return std::nullopt;
  return IncompleteRow{static_cast<std::size_t>(last->text.data() - text.data()), last->number, found, expected};
}

Recognition recognises_csv(const FileStart& file) {
  if (is_csv_heading(file.first_line)) return Recognition::certain;
  const bool is_named_csv = lower(std::filesystem::path(file.file_name).extension().string()) == ".csv";
  return is_named_csv && file.has("axis") && file.has("reading") ? Recognition::likely : Recognition::no;
}

}  // namespace

extern const FileFormat kMeasurementCsv{
    .id = "measurement_csv",
    .title = "measurement CSV",
    .sample = "x_axis.csv",
    .recognises = recognises_csv,
    .read = [](std::string_view text, const std::string& file_name,
               const ImportOptions& options) -> Result<MeasurementSet> {
      const auto cut = incomplete_last_row(text);
      const std::string_view whole = cut ? text.substr(0, cut->from) : text;
      auto set =
          options.approach_unknown ? set_with_approach_open(whole, file_name) : parse_measurement_set(whole, file_name);
      if (set && cut && !options.accept_truncated)
        return problem_at(file_name, cut->line, 1,
                          "the last line is incomplete ({} of {} fields): the file seems to be truncated. Copy it "
                          "again, or use --accept-truncated to read the {} complete readings",
                          cut->found, cut->expected, set->readings.size());
      if (set && cut) set->notes.push_back(fmt::format("truncated: line {} is incomplete and was left out", cut->line));
      const auto is_other = [&](const Reading& one) { return one.axis != *options.axis; };
      if (set && options.axis && std::ranges::any_of(set->readings, is_other))
        set->notes.push_back(fmt::format("the axis {} that was given is ignored: the rows of this file state theirs",
                                         letter_of(*options.axis, options.rotary)));
      return set;
    },
    .written_extensions = {".csv"},
    .write = [](const MeasurementSet& set, const std::string&) -> Result<std::string> { return to_csv(set); },
    .units = ErrorUnits::fixed,
    .places_in_columns = true,
};

}  // namespace ecs::laser
