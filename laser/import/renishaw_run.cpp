// Renishaw run files (.rtl .rta .rts): as they stand, and as measurement sets.

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/renishaw_file.hpp"
#include "laser/units.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

/// `NAME::` alone on a line.
std::optional<std::string> section_in(std::string_view line) {
  const std::string_view text = trimmed(line);
  if (text.size() < 3 || !text.ends_with("::")) return std::nullopt;
  const std::string_view name = trimmed(text.substr(0, text.size() - 2));
  if (name.empty() || name.find(':') != std::string_view::npos) return std::nullopt;
  return lower(name);
}

/// Walks the lines, one section at a time.
class SectionReader {
 public:
  SectionReader(RunFile& file, Findings& findings) : file_(file), findings_(findings) {}

  /// Whether this line, the next one, is a point.
  [[nodiscard]] bool in_deviations(std::string_view line) const {
    return section_ == "deviations" && !section_in(line) && !trimmed(line).empty();
  }

  void take(std::string_view line, int number) {
    if (trimmed(line).empty()) return;
    if (auto section = section_in(line)) {
      section_ = std::move(*section);
      in_targets_ = false;
      if (section_ == "eof") file_.has_end = true;
    } else if (section_ == "header") {
      take_entry(line, file_.header);
    } else if (section_ == "target data") {
      take_target_data(line, number);
    } else if (section_ == "user-text") {
      take_entry(line, file_.user_text);
    } else if (section_ == "equipment") {
      take_entry(line, file_.equipment);
    } else if (section_ == "environment") {
      take_entry(line, file_.environment);
    } else if (section_ == "runs") {
      take_run_count(line, number);
    } else if (section_ == "deviations") {
      take_point(line, number);
    }
  }

 private:
  static void take_entry(std::string_view line, std::vector<MetadataEntry>& entries) {
    if (auto entry = entry_in(line)) entries.push_back(std::move(*entry));
  }

  void take_targets(std::string_view line, std::string_view part, int number) {
    for (const std::string_view word : blank_words(part)) {
      const auto target = number_or_comma(word);
      if (target)
        file_.targets.push_back(*target);
      else
        findings_.add(number, column_of(line, word), "Targets: expected a position, found " + in_quotes(word));
    }
  }

  void take_target_data(std::string_view line, int number) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) {
      if (in_targets_) take_targets(line, line, number);
      return;
    }
    const MetadataEntry entry = *entry_in(line);
    const std::string key = lower(entry.key);
    in_targets_ = key == "targets";
    if (in_targets_) {
      take_targets(line, line.substr(colon + 1), number);
    } else if (key == "target-count") {
      file_.target_count = count_in(entry, number);
    } else if (key == "flags") {
      for (const std::string_view word : blank_words(line.substr(colon + 1)))
        file_.flags.push_back(integer_in(word).value_or(-1));
    } else {
      file_.header.push_back(entry);
    }
  }

  std::optional<long long> count_in(const MetadataEntry& entry, int number) {
    const auto count = integer_in(entry.value);
    if (!count || *count < 1)
      findings_.add(number, 1, "{}: expected a whole number above 0, found {}", entry.key, in_quotes(entry.value));
    return count;
  }

  void take_run_count(std::string_view line, int number) {
    const auto entry = entry_in(line);
    if (entry && lower(entry->key) == "run-count") file_.run_count = count_in(*entry, number);
  }

  void take_point(std::string_view line, int number) {
    if (line.find(':') != std::string_view::npos) return;  // the line "Run Target Data:"
    const auto words = blank_words(line);
    const auto run = integer_in(words[0]);
    const auto target = words.size() > 1 ? integer_in(words[1]) : std::nullopt;
    const auto deviation = words.size() > 2 ? number_or_comma(words[2]) : std::nullopt;
    const auto known = [](std::optional<long long> value) { return value && *value >= 1 && *value <= 1'000'000; };
    if (words.size() != 3 || !known(run) || !known(target) || !deviation) {
      findings_.add(number, column_of(line, words[0]),
                    "DEVIATIONS: expected run number, target number and deviation, found " + in_quotes(trimmed(line)));
      return;
    }
    file_.points.push_back({number, static_cast<int>(*run), static_cast<int>(*target), *deviation});
  }

  RunFile& file_;
  Findings& findings_;
  std::string section_;
  bool in_targets_ = false;
};

void check_points(const RunFile& file, Findings& findings) {
  std::set<std::pair<int, int>> seen;
  for (const RunPoint& point : file.points) {
    if (static_cast<std::size_t>(point.target) > file.targets.size())
      findings.add(point.line, 0, "DEVIATIONS: expected a target number up to {}, found {}", file.targets.size(),
                   point.target);
    if (file.run_count && point.run > *file.run_count)
      findings.add(point.line, 0, "DEVIATIONS: expected a run number up to {} (Run-count), found {}", *file.run_count,
                   point.run);
    if (!seen.emplace(point.run, point.target).second)
      findings.add(point.line, 0, "DEVIATIONS: expected each point once, found run {} target {} again", point.run,
                   point.target);
  }
}

constexpr std::string_view kCutShort = ": the file is truncated; --accept-truncated reads the complete part";

void check_whole(const RunFile& file, Findings& findings) {
  if (file.target_count && static_cast<std::size_t>(*file.target_count) != file.targets.size())
    findings.add(0, 0, "Targets: expected {} (Target-count), found {}", *file.target_count, file.targets.size());
  int passes = 0;
  for (const RunPoint& point : file.points) passes = std::max(passes, point.run);
  if (file.run_count && *file.run_count != passes)
    findings.add(0, 0, "DEVIATIONS: expected {} runs (Run-count), found {}{}", *file.run_count, passes, kCutShort);
  std::set<int> present;
  for (const RunPoint& point : file.points) present.insert(point.run);
  const std::size_t expected = present.size() * file.targets.size();
  if (file.points.size() != expected)
    findings.add(0, 0, "DEVIATIONS: expected {} points ({} run{} of {} targets), found {}{}", expected, present.size(),
                 present.size() == 1 ? "" : "s", file.targets.size(), file.points.size(), kCutShort);
}

}  // namespace

std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : blank_words(text))
    if (const auto number = number_or_comma(word)) numbers.push_back(*number);
  return numbers;
}

std::optional<std::string> value_of(const std::vector<MetadataEntry>& entries, std::string_view key) {
  for (const MetadataEntry& entry : entries)
    if (lower(entry.key) == lower(key) && !entry.value.empty()) return entry.value;
  return std::nullopt;
}

Result<RunFile> run_file_in(std::string_view text, const std::string& file_name, bool accept_truncated) {
  RunFile file;
  Findings findings(file_name);
  SectionReader reader(file, findings);
  const auto lines = lines_of(text);
  const bool ends_in_a_line = !text.empty() && text.back() != '\n' && text.back() != '\r';
  int number = 0;
  for (const std::string_view line : lines) {
    if (file.has_end) break;
    ++number;
    const bool cut = ends_in_a_line && static_cast<std::size_t>(number) == lines.size() && reader.in_deviations(line);
    if (cut && accept_truncated) break;  // even a number that can be read may lack digits
    const bool sound = findings.empty();
    reader.take(line, number);
    if (cut && sound && !findings.empty()) findings.add(number, 0, "the last line is incomplete{}", kCutShort);
  }
  if (file.targets.empty()) findings.add(0, 0, "TARGET DATA: expected target positions, found none");
  if (file.points.empty()) findings.add(0, 0, "DEVIATIONS: expected readings, found none. Is the file truncated?");
  if (findings.empty()) check_points(file, findings);
  if (findings.empty() && !accept_truncated) check_whole(file, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return file;
}

namespace {

constexpr double kNoSensor_degC = -10.0;  ///< what a missing material sensor reads

/// The letter X, Y or Z that is no part of a longer word ("X", "x axis", "Axis Y", "Z1"); 0 if there is none.
char axis_letter_in(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto letter = [&](std::size_t k) { return std::isalpha(static_cast<unsigned char>(text[k])) != 0; };
    const bool alone = (i == 0 || !letter(i - 1)) && (i + 1 == text.size() || !letter(i + 1));
    const char upper = static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
    if (alone && upper >= 'X' && upper <= 'Z') return upper;
  }
  return '\0';
}

Result<Axis> axis_of_file(const RunFile& file, const std::string& file_name, const ImportOptions& options,
                          std::vector<std::string>& notes) {
  const std::string text = value_of(file.user_text, "Axis").value_or("");
  const char own = axis_letter_in(text);
  if (options.axis && own != '\0' && letter_of(*options.axis, options.rotary) != own)
    notes.push_back(
        fmt::format("the file states axis {}; read as {} as requested", own, letter_of(*options.axis, options.rotary)));
  if (options.axis) return *options.axis;
  if (own != '\0') return static_cast<Axis>(own - 'X');
  return tl::unexpected(usage(file_name, fmt::format("the file does not state which linear axis moved (USER-TEXT Axis: "
                                                     "{}). Give the axis (X, Y or Z; for a rotary axis A, B or C)",
                                                     in_quotes(text))));
}

enum class Kind { linear, angular, straightness };

Result<Kind> kind_of(const RunFile& file, const std::string& file_name) {
  std::string type = lower(value_of(file.header, "File type").value_or(""));
  const std::size_t dot = file_name.rfind('.');
  if (type != "rtl" && type != "rta" && type != "rts" && dot != std::string::npos)
    type = lower(file_name.substr(dot + 1));
  if (type == "rtl") return Kind::linear;
  if (type == "rta") return Kind::angular;
  if (type == "rts") return Kind::straightness;
  return problem_at(file_name, 0, 0,
                    "HEADER File type: expected rtl, rta or rts, found neither it nor such an extension");
}

/// "EY or EZ across the axis X"
std::string senses_across(Axis axis) {
  std::vector<std::string_view> senses;
  for (const Axis other : kAllAxes)
    if (other != axis) senses.push_back(ecs::name_of(static_cast<Sense>(index_of(other))));
  return fmt::format("{} across the axis {}", fmt::join(senses, " or "), letter_of(axis));
}

Result<Sense> sense_of_file(Kind kind, Axis axis, const std::string& file_name, const ImportOptions& options) {
  const Sense positioning = static_cast<Sense>(index_of(axis));
  if (options.rotary && kind != Kind::angular)
    return tl::unexpected(
        usage(file_name, fmt::format("the file contains a {} measurement, that is lengths, and a rotary axis needs "
                                     "angles: give an angular file (.rta), or a linear axis: X, Y or Z",
                                     kind == Kind::linear ? "linear" : "straightness")));
  if (kind == Kind::linear) {
    if (options.sense.value_or(positioning) == positioning) return positioning;
    return tl::unexpected(usage(file_name, fmt::format("a linear run along {} contains {}, not {}", letter_of(axis),
                                                       ecs::name_of(positioning), ecs::name_of(*options.sense))));
  }
  const std::string choice = kind == Kind::angular ? "EA, EB or EC" : senses_across(axis);
  if (!options.sense && options.rotary && kind == Kind::angular) return static_cast<Sense>(kAxes + index_of(axis));
  if (!options.sense)
    return tl::unexpected(
        usage(file_name, fmt::format("the file does not state which error it contains: give {}", choice)));
  const bool fits = kind == Kind::angular ? is_rotation(*options.sense)
                                          : !is_rotation(*options.sense) && *options.sense != positioning;
  if (fits) return *options.sense;
  return tl::unexpected(usage(
      file_name, fmt::format("{} was given, but the file needs the sense {}", ecs::name_of(*options.sense), choice)));
}

/// Even passes of a file flagged unidirectional that hold nothing but zeros.
bool has_filled_passes(const RunFile& file) {
  const bool unidirectional = file.flags.size() > 1 && file.flags[1] == 1;
  const auto backward = [](const RunPoint& point) { return point.run % 2 == 0; };
  return unidirectional && std::ranges::any_of(file.points, backward) &&
         std::ranges::all_of(file.points,
                             [&](const RunPoint& point) { return !backward(point) || point.deviation == 0.0; });
}

struct StartAndEnd {
  double start = 0.0;
  double end = 0.0;
  [[nodiscard]] double at(double share) const { return start + share * (end - start); }
};

std::optional<StartAndEnd> start_and_end(const RunFile& file, std::string_view key, double factor) {
  const auto text = value_of(file.environment, key);
  if (!text) return std::nullopt;
  const auto numbers = numbers_of(*text);
  if (numbers.empty()) return std::nullopt;
  return StartAndEnd{numbers[0] * factor, (numbers.size() > 1 ? numbers[1] : numbers[0]) * factor};
}

/// A material sensor; one that was not there at the start or at the end has the other value throughout.
std::optional<StartAndEnd> material_of(const RunFile& file, std::string_view key) {
  auto value = start_and_end(file, key, 1.0);
  if (!value) return std::nullopt;
  if (value->start == kNoSensor_degC) value->start = value->end;
  if (value->end == kNoSensor_degC) value->end = value->start;
  return value->start == kNoSensor_degC ? std::nullopt : value;
}

/// Air pressure is kPa by a flag of 1 or by its size; a size that fits hPa is taken as hPa, any other is not used.
std::optional<StartAndEnd> pressure_of(const RunFile& file, std::vector<std::string>& notes) {
  const auto raw = start_and_end(file, "Air press", 1.0);
  if (!raw) return std::nullopt;
  if (raw->start > 40.0 && raw->start < 120.0) return StartAndEnd{raw->start * kHPaPerKPa, raw->end * kHPaPerKPa};
  if (raw->start > 400.0 && raw->start < 1200.0) {
    notes.push_back("Air press read as hPa because of its size");
    return raw;
  }
  notes.push_back("Air press is neither kPa nor hPa, judging by its size: not used");
  return std::nullopt;
}

struct Environment {
  std::optional<StartAndEnd> air, pressure, humidity;
  std::vector<std::pair<std::string, StartAndEnd>> material;
  [[nodiscard]] bool empty() const { return !air && !pressure && !humidity && material.empty(); }
};

Environment environment_of(const RunFile& file, std::vector<std::string>& notes) {
  Environment environment{
      start_and_end(file, "Air temp", 1.0), pressure_of(file, notes), start_and_end(file, "Air humid", 1.0), {}};
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kMaterial{
      {{"Mat temp 1", "t_material_degC"}, {"Mat temp 2", "t_material2_degC"}, {"Mat temp 3", "t_material3_degC"}}};
  for (const auto& [key, column] : kMaterial) {
    if (const auto value = material_of(file, key)) environment.material.emplace_back(column, *value);
  }
  return environment;
}

void set_environment(Reading& reading, const Environment& environment, double share) {
  if (environment.air) reading.sensors_degC["t_air_degC"] = environment.air->at(share);
  for (const auto& [column, value] : environment.material) reading.sensors_degC[column] = value.at(share);
  if (environment.pressure) reading.pressure_hPa = environment.pressure->at(share);
  if (environment.humidity) reading.humidity_pct = environment.humidity->at(share);
}

void spread(MeasurementSet& set, const Environment& environment, bool over_all) {
  if (environment.empty() || set.readings.empty()) return;
  const std::size_t last = set.readings.size() - 1;
  for (std::size_t i = 0; i <= last; ++i)
    if (over_all || i == 0 || i == last)
      set_environment(set.readings[i], environment,
                      last == 0 ? 0.0 : static_cast<double>(i) / static_cast<double>(last));
  if (over_all)
    set.notes.push_back(
        "air and material values are interpolated linearly between start and end: the file has only these two");
}

/// Keys in the spelling of most versions, whatever case this one used.
std::string usual_spelling(const std::string& key) {
  constexpr std::array<std::string_view, 20> kKeys{"File type",  "Owner",      "Version no", "Filetype",  "Machine",
                                                   "Serial No",  "Date",       "By",         "Axis",      "Location",
                                                   "TITLE",      "Air temp",   "Air press",  "Air humid", "Mat temp 1",
                                                   "Mat temp 2", "Mat temp 3", "Env factor", "Exp coeff", "Date Time"};
  for (const std::string_view usual : kKeys)
    if (lower(usual) == lower(key)) return std::string(usual);
  return key;
}

void add_metadata(MeasurementSet& set, const RunFile& file) {
  for (const auto* const entries : {&file.header, &file.user_text, &file.equipment, &file.environment})
    for (const MetadataEntry& entry : *entries) set.metadata.push_back({usual_spelling(entry.key), entry.value});
}

/// Linear (.rtl, um), angular (.rta, mrad, here um/m), straightness (.rts, um); sections `NAME::`, one line `run target
/// deviation` for each point; the target number decides, not the order of lines. Odd runs go in the direction of the
/// target list, even ones back; approach is the sign of that motion, so a descending list starts with reverse. Two
/// passes make one run. Zero-filled backward passes of a file flagged unidirectional are left out.
Result<MeasurementSet> read_run(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  ECS_TRY(file, run_file_in(text, file_name, options.accept_truncated));
  MeasurementSet set;
  set.source = file_name;
  ECS_TRY(kind, kind_of(file, file_name));
  ECS_TRY(axis, axis_of_file(file, file_name, options, set.notes));
  ECS_TRY(sense, sense_of_file(kind, axis, file_name, options));
  add_metadata(set, file);
  const bool descending = file.targets.back() < file.targets.front();
  const bool filled = has_filled_passes(file);
  const double factor = kind == Kind::angular ? kUmPerMPerMrad : 1.0;
  for (const RunPoint& point : file.points) {
    const bool along_list = point.run % 2 == 1;
    if (filled && !along_list) continue;
    Reading reading;
    reading.line = point.line;
    reading.axis = axis;
    reading.sense = sense;
    reading.position_mm = position_at(options, axis, file.targets[static_cast<std::size_t>(point.target) - 1]);
    reading.error = point.deviation * factor;
    reading.approach = along_list != descending ? Approach::forward : Approach::reverse;
    reading.run = (point.run + 1) / 2;
    set.readings.push_back(std::move(reading));
  }
  if (descending) set.notes.push_back("targets descend: odd passes approach in reverse");
  if (filled) set.notes.push_back("marked unidirectional: backward passes of zeros are ignored");
  if (!file.has_end) set.notes.push_back("no EOF section: the file may be truncated");
  spread(set, environment_of(file, set.notes), options.spread_environment);
  number_rows(set);
  return set;
}

Recognition recognises_run(const FileStart& file) {
  return file.has("target data::") || file.has("deviations::") ? Recognition::certain : Recognition::no;
}

Result<std::string> write_run(const MeasurementSet& set, const std::string& file_name) {
  const std::string extension = lower(std::filesystem::path(file_name).extension().string());
  if (!set.readings.empty() && renishaw_extension(set) != extension)
    return problem(ProblemKind::usage, "{}: these readings need a {} file, not {}", file_name, renishaw_extension(set),
                   extension);
  return to_renishaw_run(set);
}

}  // namespace

extern const FileFormat kRenishawRun{
    .id = "renishaw_run",
    .title = "Renishaw run file (.rtl .rta .rts)",
    .sample = "vmc_x.rtl",
    .recognises = recognises_run,
    .read = read_run,
    .written_extensions = {".rtl", ".rta", ".rts"},
    .write = write_run,
    .holds_um = true,
};

}  // namespace ecs::laser
