#include "commissioning/laser_session/lines.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/work.hpp"
#include "commissioning/measurements/mapped_table.hpp"
#include "commissioning/session/commands.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/import/import.hpp"
#include "laser/map/csv.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::array<std::pair<const char*, std::string laser::MapRecipe::*>, 6> kHeaderKeys{
    {{"customer", &laser::MapRecipe::customer},
     {"machine", &laser::MapRecipe::machine},
     {"serial_number", &laser::MapRecipe::serial_number},
     {"engineer", &laser::MapRecipe::engineer},
     {"date", &laser::MapRecipe::date},
     {"remarks", &laser::MapRecipe::remark}}};

Json json_of(const LaserLineChoice& line) {
  Json runs = Json::array(), readings = Json::array();
  for (const auto& [run, reason] : line.runs) runs.push_back({run, reason});
  for (const auto& [place, reason] : line.readings) readings.push_back({place, reason});
  return {{"runs", runs}, {"readings", readings}};
}

LaserLineChoice line_in(const Json& object) {
  LaserLineChoice line;
  for (const Json& one : object.at("runs")) line.runs.emplace(one.at(0).get<int>(), one.at(1).get<std::string>());
  for (const Json& one : object.at("readings"))
    line.readings.emplace(one.at(0).get<std::size_t>(), one.at(1).get<std::string>());
  return line;
}

/// By code: what is done to it, or why it is declared zero.
std::map<std::string, Json> components_of(const laser::MapRecipe& recipe) {
  std::map<std::string, Json> components;
  for (std::size_t k = 0; k < kComponents; ++k) {
    const auto component = static_cast<Component>(k);
    const laser::ComponentRecipe one = laser::settings_of(recipe, component);
    const std::string reason = laser::zero_reason(recipe, component);
    if (one == laser::settings_of({}, component) && reason.empty()) continue;
    Json& object = components[std::string(name_of(component))];
    object = {{"smoothing_mm", one.smoothing_mm}, {"zero_reason", reason}};
    if (one.slope) object["slope"] = laser::name_of(*one.slope);
    if (one.increment_mm) object["increment_mm"] = *one.increment_mm;
  }
  return components;
}

void take_component(laser::MapRecipe& recipe, Component component, const Json& object) {
  laser::ComponentRecipe& one = laser::settings_in(recipe, component);
  one.smoothing_mm = object.at("smoothing_mm").get<double>();
  laser::declare_zero(recipe, component, object.at("zero_reason").get<std::string>());
  if (object.contains("slope")) one.slope = laser::slope_method_named(object["slope"].get<std::string>());
  if (object.contains("increment_mm")) one.increment_mm = object["increment_mm"].get<double>();
}

LaserChoices choices_of(const Json& object) {
  LaserChoices choices;
  for (const Json& one : object.at("files")) {
    LaserFileChoice file{one.at("path").get<std::string>(), {}};
    for (const auto& [name, value] : one.at("answers").items()) (void)set_answer(file.answers, name, value);
    file.places = one.value("places", file.places);
    choices.files.push_back(std::move(file));
  }
  for (const auto& [key, line] : object.at("lines").items()) choices.lines[key] = line_in(line);
  for (const auto& [code, one] : object.at("components").items())
    if (const auto component = component_of(code)) take_component(choices.recipe, *component, one);
  choices.params_file = object.at("params").get<std::string>();
  choices.scope = object.at("scope").get<std::string>();
  for (const auto& [key, member] : kHeaderKeys) choices.recipe.*member = object.at("header").at(key).get<std::string>();
  choices.map_file = object.at("map").get<std::string>();
  choices.opened_map = object.value("opened_map", "");
  return choices;
}

}  // namespace

std::string choices_text(const LaserChoices& choices) {
  Json header;
  for (const auto& [key, member] : kHeaderKeys) header[key] = choices.recipe.*member;
  Json object{
      {"files", Json::array()},        {"lines", Json::object()},         {"components", components_of(choices.recipe)},
      {"params", choices.params_file}, {"scope", choices.scope},          {"header", header},
      {"map", choices.map_file},       {"opened_map", choices.opened_map}};
  for (const LaserFileChoice& file : choices.files)
    object["files"].push_back({{"path", file.path}, {"answers", given_answers(file.answers)}, {"places", file.places}});
  for (const auto& [key, line] : choices.lines)
    if (!(line == LaserLineChoice{})) object["lines"][key] = json_of(line);
  return one_line(object);
}

std::optional<LaserChoices> choices_in(const std::string& text) {
  try {
    return choices_of(Json::parse(text));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

namespace {

std::string key_of(const laser::Group& group, bool square) {
  std::string key = fmt::format("{} along {} at {}", name_of(group.sense), letter_of(group.axis), parked_text(group));
  if (square) key += ", square";
  if (group.compensated.value_or(false)) key += ", compensated";
  return key;
}

/// The axis that moves stays where it was.
void put_at(laser::MeasurementSet& set, const PerAxis<bool>& which, const Vector3& place_mm) {
  for (laser::Reading& reading : set.readings)
    for (const Axis a : kAllAxes)
      if (const std::size_t k = index_of(a); which[k] && a != reading.axis) reading.position_mm[k] = place_mm[k];
}

/// Which places file or answers say. A measurement CSV takes from the answers what it has no column for.
PerAxis<bool> take_places(laser::Imported& imported, const ImportArguments& given) {
  const auto options = import_options(given);
  if (!options) return {};
  PerAxis<bool> known = laser::places_stated(imported, *options), answered{};
  for (std::size_t k = 0; k < known.size(); ++k) {
    answered[k] = options->parked_stated[k] && !known[k];
    known[k] = known[k] || answered[k];
  }
  if (imported.format->places_in_columns) put_at(imported.set, answered, options->parked_mm);
  return known;
}

/// Where the axes stand that do not move, a ? for what nothing says.
void take_place(LaserLine& line, const PerAxis<bool>& known) {
  line.place.clear();
  line.place_unknown.clear();
  for (const Axis a : kAllAxes) {
    if (a == line.group.axis) continue;
    line.place += line.place.empty() ? "" : ", ";
    if (known[index_of(a)]) {
      line.place += fmt::format("{} {:.6g}", letter_of(a), line.group.parked_mm[index_of(a)]);
    } else {
      line.place += fmt::format("{} ?", letter_of(a));
      line.place_unknown.push_back(a);
    }
  }
}

/// The readings of one line in one file.
struct Part {
  laser::MeasurementSet set;
  std::string file;
  std::string whole_file_sha256;  ///< empty: the file holds other lines too, or needs answers
  bool square = false;
  PerAxis<bool> position_known{};
  std::string stated;  ///< key of the line as the file states it
  std::string note{};
};

/// The readings at the place that is given.
void put_at(Part& part, const std::string& parked) {
  ImportArguments given;
  given.parked = parked;
  const auto options = import_options(given);
  if (!options) return;
  put_at(part.set, options->parked_stated, options->parked_mm);
  for (std::size_t k = 0; k < part.position_known.size(); ++k)
    part.position_known[k] = part.position_known[k] || options->parked_stated[k];
  part.whole_file_sha256.clear();
}

/// The line as a file states it, or at the place that corrects that.
Part part_of(const LaserFile& file, const laser::Group& group, bool square, bool alone) {
  const bool says_all = alone && given_answers(file.choice.answers).empty();
  Part part{set_of(*file.set, group), file.choice.path,     says_all ? file.sha256 : "", square,
            file.position_known,      key_of(group, square)};
  const auto corrected = file.choice.places.find(part.stated);
  if (corrected == file.choice.places.end()) return part;
  put_at(part, corrected->second);
  part.note = fmt::format("position corrected to {}; {} states {}", corrected->second,
                          std::filesystem::path(part.file).filename().string(), parked_text(group));
  return part;
}

LaserLine line_of(std::string key, laser::MeasurementSet set, const Part& first) {
  LaserLine line;
  line.key = std::move(key);
  line.square = first.square;
  line.set = std::make_shared<const laser::MeasurementSet>(std::move(set));
  line.summary = lines_in(*line.set).front();
  line.group = line.summary.group;
  line.component = curve_of(line.group.sense, line.group.axis);
  take_place(line, first.position_known);
  if (line.square) line.component = laser::squareness_shown(line.group.axis, line.group.sense).value_or(line.component);
  line.suspects = laser::outliers_of(*line.set, line.group);
  return line;
}

std::vector<LaserLine> lines_of_parts(const std::string& key, std::vector<Part>& parts) {
  std::vector<LaserLine> lines;
  std::vector<laser::MeasurementSet> sets;
  for (const Part& part : parts) sets.push_back(part.set);
  auto all = joined(sets);
  if (all) {
    lines.push_back(line_of(key, std::move(*all), parts.front()));
    PerAxis<bool> known = parts.front().position_known;
    for (const Part& part : parts) {
      lines.back().files.push_back(part.file);
      lines.back().stated.push_back(part.stated);
      if (!part.note.empty()) lines.back().notes.push_back(part.note);
      for (std::size_t k = 0; k < known.size(); ++k) known[k] = known[k] && part.position_known[k];
    }
    take_place(lines.back(), known);
    if (parts.size() == 1) lines.back().whole_file_sha256 = parts.front().whole_file_sha256;
    if (parts.size() > 1) lines.back().notes.push_back(fmt::format("{} files are one line here", parts.size()));
    return lines;
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    lines.push_back(line_of(k == 0 ? key : fmt::format("{}, file {}", key, k + 1), parts[k].set, parts[k]));
    lines.back().files = {parts[k].file};
    lines.back().stated = {parts[k].stated};
    lines.back().whole_file_sha256 = parts[k].whole_file_sha256;
    lines.back().notes.push_back("not joined: " + to_text(all.error()));
  }
  return lines;
}

}  // namespace

std::string stamp_of(const std::string& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) return {};
  return fmt::format("{} {}.{:09}", facts.st_size, facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec);
}

LaserFile read_laser_file(const LaserFileChoice& choice) {
  LaserFile file;
  file.choice = choice;
  file.stamp = stamp_of(choice.path);
  if (choice.answers.columns.empty() && MappedTable::of_file(choice.path, choice.answers)) {
    file.problem = "A table that no format describes: press Enter to assign a role and a unit to its columns.";
    file.wants_answers = file.wants_columns = true;
    return file;
  }
  ImportArguments answered;
  auto imported = read_measurements(choice.path, choice.answers, &answered);
  if (!imported) {
    file.problem = to_text(imported.error());
    if (const auto map = laser::read_map_csv(choice.path)) {
      file.is_map = true;
      file.format = "error map";
      file.summary = fmt::format("{} tables", map->tables.size());
      return file;
    }
    const bool explained = file.problem.find("--") != std::string::npos;
    file.wants_answers = imported.error().kind == ProblemKind::usage || explained;
    return file;
  }
  file.format = imported->format->title;
  file.format = file.format.substr(0, file.format.find(" ("));
  if (imported->set.readings.empty()) {
    file.problem = "it contains no readings";
    return file;
  }
  file.position_known = take_places(*imported, answered);
  std::vector<std::string> names;
  for (const laser::Group& group : laser::groups_of(imported->set)) {
    const auto square =
        laser::is_square(imported->set) ? laser::squareness_shown(group.axis, group.sense) : std::nullopt;
    names.emplace_back(name_of(square.value_or(curve_of(group.sense, group.axis))));
  }
  const std::set<std::string> different(names.begin(), names.end());
  file.summary =
      names.size() > 4 ? fmt::format("{} lines", names.size()) : fmt::format("{}", fmt::join(different, " "));
  file.summary += fmt::format(", {} readings", imported->set.readings.size());
  file.set = std::make_shared<const laser::MeasurementSet>(std::move(imported->set));
  file.sha256 = std::move(imported->sha256);
  return file;
}

const LaserFile* file_read(const std::vector<LaserFile>& files, const LaserFileChoice& choice) {
  const auto found = std::find_if(files.begin(), files.end(), [&](const LaserFile& file) {
    return file.choice.path == choice.path && given_answers(file.choice.answers) == given_answers(choice.answers);
  });
  return found == files.end() ? nullptr : &*found;
}

Result<void> correct_place(LaserChoices& choices, const LaserLine& line, const std::string& parked) {
  ImportArguments given;
  given.parked = parked;
  ECS_DO(import_options(given));
  for (std::size_t k = 0; k < line.files.size(); ++k)
    for (LaserFileChoice& file : choices.files)
      if (file.path == line.files[k]) {
        if (parked.empty())
          file.places.erase(line.stated[k]);
        else
          file.places[line.stated[k]] = parked;
      }
  Part moved{*line.set, {}, {}, line.square, {}, {}};
  put_at(moved, parked);
  if (auto left_out = choices.lines.extract(line.key)) {  // stays with the line
    left_out.key() = key_of(laser::groups_of(moved.set).front(), line.square);
    choices.lines.insert(std::move(left_out));
  }
  return {};
}

std::string missing_place_of(const LaserLine& line) {
  if (line.place_unknown.empty()) return {};
  std::string axes;
  for (const Axis a : line.place_unknown) axes += fmt::format("{}{}", axes.empty() ? "" : " and ", letter_of(a));
  return fmt::format("parked position of {} not in the file: 0 until set (press Enter)", axes);
}

std::string name_of_line(const LaserLine& line) {
  return fmt::format("{}{}", name_of(line.component), line.square ? " (square)" : "");
}

std::vector<LaserLine> laser_lines(const std::vector<LaserFile>& files) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<Part>> parts;
  for (const LaserFile& file : files) {
    if (!file.set) continue;
    const auto groups = laser::groups_of(*file.set);
    const bool square = laser::is_square(*file.set);
    for (const laser::Group& group : groups) {
      Part part = part_of(file, group, square, groups.size() == 1);
      const std::string key = key_of(laser::groups_of(part.set).front(), square);
      if (!parts.contains(key)) order.push_back(key);
      parts[key].push_back(std::move(part));
    }
  }
  std::vector<LaserLine> lines;
  for (const std::string& key : order)
    for (LaserLine& line : lines_of_parts(key, parts[key])) lines.push_back(std::move(line));
  std::stable_sort(lines.begin(), lines.end(),
                   [](const LaserLine& a, const LaserLine& b) { return a.component < b.component; });
  return lines;
}

namespace {

std::string with_reason(std::string what, const std::string& reason) {
  return reason.empty() ? what : fmt::format("{} ({})", what, reason);
}

/// The line that one of its files states so; null: there is none.
const LaserLine* line_stated(const std::vector<LaserLine>& lines, const std::string& stated) {
  if (stated.empty()) return lines.size() == 1 ? &lines.front() : nullptr;
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const LaserLine& line) {
    return line.key == stated || std::find(line.stated.begin(), line.stated.end(), stated) != line.stated.end();
  });
  return found == lines.end() ? nullptr : &*found;
}

tl::unexpected<Problem> no_such_line(const std::vector<LaserLine>& lines, const std::string& sought) {
  std::vector<std::string> keys;
  for (const LaserLine& line : lines) keys.push_back(fmt::format("\"{}\"", line.key));
  return problem(ProblemKind::usage, "--line: expected one of the measured lines, {}; found {}", fmt::join(keys, ", "),
                 sought.empty() ? std::string("none") : fmt::format("\"{}\"", sought));
}

/// What is left out must be there: else it is probably a typing error.
Result<void> all_there(const LaserLine& line, const LaserLineChoice& left_out) {
  std::set<int> runs;
  for (const laser::Reading& reading : line.set->readings) runs.insert(reading.run);
  for (const auto& [run, reason] : left_out.runs)
    if (!runs.contains(run))
      return problem(ProblemKind::usage, "--leave-out-run {}: there is no such run; existing: {}", run,
                     fmt::join(runs, ", "));
  for (const auto& [place, reason] : left_out.readings)
    if (place >= line.set->readings.size())
      return problem(ProblemKind::usage, "--leave-out-reading {}: the line has {} readings", place + 1,
                     line.set->readings.size());
  return {};
}

/// "3=vibration", "3".
Result<std::pair<int, std::string>> left_out_in(const std::string& word, const char* option) {
  const std::size_t equals = word.find('=');
  const auto number = integer_in(word.substr(0, equals));
  if (!number || *number < 1 || *number > 1'000'000'000)
    return problem(ProblemKind::usage, "{}: expected a number from 1, or number=reason; found \"{}\"", option, word);
  return std::pair(static_cast<int>(*number), equals == std::string::npos ? std::string() : word.substr(equals + 1));
}

std::string with_equals(const std::string& number, const std::string& reason) {
  return reason.empty() ? number : number + "=" + reason;
}

}  // namespace

laser::MeasurementSet prepared_set(const LaserLine& line, const LaserLineChoice& choice) {
  laser::MeasurementSet set = line_result(line, choice).chosen;
  for (const std::string& file : line.files)
    set.metadata.push_back({"prepared_from", std::filesystem::path(file).filename().string()});
  for (const auto& [run, reason] : choice.runs)
    set.metadata.push_back({"left_out", with_reason(fmt::format("run {}", run), reason)});
  for (const auto& [place, reason] : choice.readings) {
    if (place >= line.set->readings.size()) continue;
    const laser::Reading& reading = line.set->readings[place];
    set.metadata.push_back(
        {"left_out",
         with_reason(fmt::format("run {} at {} mm", reading.run, shortest(laser::target_mm(reading))), reason)});
  }
  return set;
}

cli::Fields<PrepareRequest> PrepareRequest::fields() {
  using R = PrepareRequest;
  return {{"FILE", &R::files, "measurement files of the line; they are joined", cli::Need::required},
          {"--line", &R::line, "line to use if the files contain several: \"EX along X at Y -1400, Z 0\""},
          {"--place", &R::place, "position of the other axes; overrides --parked and the files: y=-1400,z=0"},
          {"--leave-out-run", &R::runs, "run to exclude: 3, or 3=vibration to record the reason"},
          {"--leave-out-reading", &R::readings,
           "reading of the line to exclude, counted from 1: 17, or \"17=beam broken\""},
          {"-o,--output", &R::output, "measurement CSV to write", cli::Is::output, cli::Need::required},
          &R::import};
}

Result<laser::MeasurementSet> prepared_line(const PrepareRequest& request) {
  LaserLineChoice left_out;
  for (const std::string& word : request.runs) {
    ECS_TRY(run, left_out_in(word, "--leave-out-run"));
    left_out.runs[run.first] = run.second;
  }
  for (const std::string& word : request.readings) {
    ECS_TRY(reading, left_out_in(word, "--leave-out-reading"));
    left_out.readings[static_cast<std::size_t>(reading.first) - 1] = reading.second;
  }
  LaserChoices choices;
  for (const std::string& file : request.files) choices.files.push_back({file, request.import});
  const auto read = [&choices] {
    std::vector<LaserFile> files;
    for (const LaserFileChoice& choice : choices.files) files.push_back(read_laser_file(choice));
    return files;
  };
  std::vector<LaserFile> files = read();
  for (const LaserFile& file : files)
    if (!file.set) return problem(ProblemKind::bad_input, file.problem);
  std::vector<LaserLine> lines = laser_lines(files);
  const LaserLine* line = line_stated(lines, request.line);
  if (line == nullptr) return no_such_line(lines, request.line);
  if (!request.place.empty()) {
    const std::string stated = line->stated.front();
    ECS_DO(correct_place(choices, *line, request.place));
    lines = laser_lines(read());
    line = line_stated(lines, stated);
    if (line == nullptr) return no_such_line(lines, stated);
  }
  ECS_DO(all_there(*line, left_out));
  laser::MeasurementSet prepared = prepared_set(*line, left_out);
  if (prepared.readings.empty())
    return problem(ProblemKind::refused, "{}: every reading is excluded", fmt::join(line->files, ", "));
  return prepared;
}

std::optional<std::vector<std::string>> prepare_words(const LaserLine& line, const LaserLineChoice& left_out,
                                                      const std::vector<LaserFileChoice>& files,
                                                      const std::string& output) {
  std::vector<std::string> words{"laser", "prepare"}, import;
  std::string place;
  for (std::size_t k = 0; k < line.files.size(); ++k) {
    const auto file = std::find_if(files.begin(), files.end(), [&](const auto& f) { return f.path == line.files[k]; });
    if (file == files.end()) return std::nullopt;
    const auto corrected = file->places.find(line.stated[k]);
    const std::string place_here = corrected == file->places.end() ? std::string() : corrected->second;
    const auto import_here = import_words(file->answers);
    if (k > 0 && (place_here != place || import_here != import || line.stated[k] != line.stated.front()))
      return std::nullopt;
    place = place_here;
    import = import_here;
    words.push_back(path_word(file->path));
  }
  words.insert(words.end(), {"--line", line.stated.front()});
  if (!place.empty()) words.insert(words.end(), {"--place", place});
  for (const auto& [run, reason] : left_out.runs)
    words.insert(words.end(), {"--leave-out-run", with_equals(std::to_string(run), reason)});
  for (const auto& [at, reason] : left_out.readings)
    words.insert(words.end(), {"--leave-out-reading", with_equals(std::to_string(at + 1), reason)});
  words.insert(words.end(), import.begin(), import.end());
  words.insert(words.end(), {"-o", path_word(output)});
  return words;
}

}  // namespace ecs::commissioning
