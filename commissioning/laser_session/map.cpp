// The map that the chosen files, parameters and components give, what is missing for it, and its files on disc.

#include <algorithm>
#include <ctime>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/laser_session/work.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/records.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/recipe.hpp"
#include "laser/writers/writers.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {

namespace fs = std::filesystem;

LaserLineChoice choice_for_line(const LaserChoices& choices, const LaserLine& line) {
  const auto found = choices.lines.find(line.key);
  return found == choices.lines.end() ? LaserLineChoice{} : found->second;
}

namespace {

constexpr const char* kScopeKey = "compensation.scope";
/// Stands for the folder of the prepared files until the map is saved.
constexpr const char* kPrepared = "(prepared)";

bool is_compensated(const LaserLine& line) { return line.group.compensated.value_or(false); }

/// A name of its own for each line of the list.
fs::path prepared_path(const std::vector<LaserLine>& lines, std::size_t at) {
  return kPrepared / fs::path(fmt::format("{}_line{}.csv", fs::path(lines[at].files.front()).stem().string(), at + 1));
}
bool is_prepared(const fs::path& file) { return file.parent_path() == kPrepared; }

/// The file that a map names for a line: its own where that says all of it.
fs::path source_of(const LaserChoices& choices, const std::vector<LaserLine>& lines, std::size_t at) {
  const bool as_it_is = !lines[at].whole_file_sha256.empty() && choice_for_line(choices, lines[at]).readings.empty();
  return as_it_is ? fs::path(lines[at].files.front()) : prepared_path(lines, at);
}

std::string prepared_csv(const LaserChoices& choices, const LaserLine& line) {
  return laser::to_csv(prepared_set(line, choice_for_line(choices, line)));
}

/// As the files will be read once the map is saved.
laser::FileReader reader_of(const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  return [&](const fs::path& path) -> Result<laser::Imported> {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const LaserLine& line = lines[k];
      if (!line.whole_file_sha256.empty() && line.files.front() == path)
        return laser::Imported{nullptr, *line.set, {}, line.whole_file_sha256};
      if (prepared_path(lines, k) != path) continue;
      const std::string csv = prepared_csv(choices, line);
      ECS_TRY(imported, laser::parse_any(csv, path.string(), {}));
      imported.sha256 = sha256_hex(csv);
      return imported;
    }
    return laser::read_plain(path);
  };
}

std::string from_lines(const laser::SuggestedRecipe& suggested, Component component) {
  std::vector<std::string> names;
  for (const laser::ComponentRecipe& one : suggested.recipe.components)
    if (one.component == component)
      for (const fs::path& file : one.files)
        if (names.empty() || names.back() != file.filename()) names.push_back(file.filename().string());
  return fmt::format("{}", fmt::join(names, " and "));
}

/// Why the lines that measure a curve are not used for it; empty: there are none.
std::string why_unused(const laser::SuggestedRecipe& suggested, Component component) {
  if (is_squareness(component)) return {};
  const std::string measured =
      fmt::format("({} along {}): ", name_of(sense_of(component)), letter_of(moving_axis(component)));
  std::vector<std::string> reasons;
  for (const std::string& unused : suggested.unused)
    if (const std::size_t at = unused.find(measured); at != std::string::npos)
      reasons.push_back(unused.substr(at + measured.size()));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

LaserComponent state_of(const LaserMapWork& work, Component component) {
  LaserComponent out{component, ComponentState::missing, {}};
  if (std::string reason = laser::zero_reason(work.recipe, component); !reason.empty())
    return {component, ComponentState::zero, std::move(reason)};
  const std::string files = from_lines(work.suggested, component);
  const std::string code = std::string(name_of(component)) + ":";
  for (const std::string& refusal : work.refusals)
    if (!files.empty() && refusal.find(code) != std::string::npos) return {component, ComponentState::refused, refusal};
  if (!files.empty()) return {component, ComponentState::present, files};
  const double held = is_squareness(component) ? squareness_um_per_m(work.parameters->parameters, component) : 0.0;
  if (held != 0.0)
    return {component, ComponentState::in_parameters, fmt::format("{:.2f} um/m in the parameters", held)};
  out.detail = why_unused(work.suggested, component);
  return out;
}

void take_components(LaserMapWork& work) {
  const ComponentSet needed = components_needed(work.parameters->parameters);
  for (std::size_t k = 0; k < kComponents; ++k)
    if (needed.contains(static_cast<Component>(k)))
      work.components.push_back(state_of(work, static_cast<Component>(k)));
}

/// Without those that only another scope needs: the choices keep them.
std::vector<laser::DeclaredZero> zeros_needed(const LaserMapWork& work, const LaserChoices& choices) {
  std::vector<laser::DeclaredZero> zeros = choices.recipe.declared_zero;
  const ComponentSet needed = components_needed(work.parameters->parameters);
  std::erase_if(zeros, [&](const laser::DeclaredZero& zero) { return !needed.contains(zero.component); });
  return zeros;
}

/// What is chosen, for the files that are suggested.
laser::MapRecipe full_recipe(const LaserMapWork& work, const LaserChoices& choices,
                             const std::vector<LaserLine>& lines) {
  laser::MapRecipe recipe = choices.recipe;
  const laser::MapRecipe header = header_with_files(choices.recipe, lines);
  recipe.customer = header.customer;
  recipe.engineer = header.engineer;
  recipe.date = header.date;
  recipe.declared_zero = zeros_needed(work, choices);
  recipe.components.clear();
  for (const laser::ComponentRecipe& suggested : work.suggested.recipe.components) {
    if (!laser::zero_reason(choices.recipe, suggested.component).empty()) continue;
    laser::ComponentRecipe one = laser::settings_of(choices.recipe, suggested.component);
    one.files = suggested.files;
    const auto behind = lines_behind(one, lines);
    for (std::size_t k = 0; k < std::min(behind.size(), one.files.size()); ++k) {
      const LaserLineChoice left = choice_for_line(choices, lines[behind[k]]);
      if (left.runs.empty() || is_prepared(one.files[k])) continue;
      if (one.files.size() > 1)
        one.files[k] = prepared_path(lines, behind[k]);
      else
        for (const auto& [run, reason] : left.runs) one.exclude_runs.push_back(run);
    }
    recipe.components.push_back(std::move(one));
  }
  return recipe;
}

void take_refusal(LaserMapWork& work, const Problem& why) {
  Problem first = why;
  first.also.clear();
  work.refusals.push_back(to_text(first));
  for (const Problem& other : why.also) work.refusals.push_back(to_text(other));
}

}  // namespace

const std::vector<laser::MapFinding>& LaserMapWork::findings() const {
  static const std::vector<laser::MapFinding> kNone;
  return made ? made->findings : kNone;
}

std::size_t LaserMapWork::missing() const {
  return static_cast<std::size_t>(std::count_if(components.begin(), components.end(), [](const LaserComponent& c) {
    return c.state == ComponentState::missing || c.state == ComponentState::refused;
  }));
}

namespace {

/// The dates that the files state, in any form.
std::vector<std::string> dates_in(const std::vector<LaserLine>& lines) {
  std::vector<std::string> dates;
  for (const LaserLine& line : lines)
    for (const char* key : {"date", "Date"})
      if (std::string date = laser::metadata_value(*line.set, key).value_or(""); !date.empty())
        dates.push_back(std::move(date));
  return dates;
}

/// The first date of the files that is one; else today, where no file is dated in any form.
std::string date_of(const std::vector<LaserLine>& lines) {
  const std::vector<std::string> dates = dates_in(lines);
  if (dates.empty()) return fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)));
  const auto first = std::ranges::find_if(dates, [](const std::string& date) { return is_iso_date(date); });
  return first == dates.end() ? "" : *first;
}

}  // namespace

bool states_date(const std::vector<LaserLine>& lines) { return !dates_in(lines).empty(); }

laser::MapRecipe header_with_files(laser::MapRecipe header, const std::vector<LaserLine>& lines) {
  const auto fill = [&](std::string& field, std::initializer_list<const char*> keys) {
    for (const LaserLine& line : lines)
      for (const char* key : keys)
        if (field.empty()) field = laser::metadata_value(*line.set, key).value_or("");
  };
  fill(header.customer, {"customer", "Customer"});
  fill(header.machine, {"machine", "Machine"});
  fill(header.serial_number, {"serial_number", "Serial No"});
  fill(header.engineer, {"engineer", "operator", "Operator", "By"});
  if (!is_iso_date(header.date)) header.date = date_of(lines);
  return header;
}

namespace {

/// With the scope chosen.
void take_parameters(LaserMapWork& work, const LaserChoices& choices) {
  if (choices.params_file.empty()) return;
  auto read = params::read_whole_parameters(choices.params_file);
  if (!read) {
    work.parameters_problem = to_text(read.error());
    return;
  }
  if (!choices.scope.empty()) (void)params::set(read->parameters, kScopeKey, choices.scope);
  work.parameters = std::move(*read);
}

/// Which line serves which component. A line that a map cannot name as it is stands for the file prepared of it.
void assign_lines(LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (!is_compensated(lines[k])) files.push_back(source_of(choices, lines, k));
  auto suggested = laser::suggest_recipe(files, work.parameters->parameters, reader_of(choices, lines));
  if (!suggested) return work.refusals.push_back(to_text(suggested.error()));
  work.suggested = std::move(*suggested);
  std::ranges::stable_sort(work.suggested.recipe.components, {}, &laser::ComponentRecipe::component);
  for (const LaserLine& line : lines)
    if (is_compensated(line))
      work.suggested.unused.push_back(name_of_line(line) + ": measured with compensation active");
}

}  // namespace

std::vector<std::size_t> lines_behind(const laser::ComponentRecipe& component, const std::vector<LaserLine>& lines) {
  std::vector<std::size_t> behind;
  for (const fs::path& file : component.files)
    for (std::size_t k = 0; k < lines.size(); ++k)
      if (!is_compensated(lines[k]) && ((!lines[k].whole_file_sha256.empty() && lines[k].files.front() == file) ||
                                        prepared_path(lines, k) == file)) {
        behind.push_back(k);
        break;
      }
  return behind;
}

namespace {

void take_made(LaserMapWork& work, Result<MadeMap> made) {
  if (!made) return take_refusal(work, made.error());
  work.csv = laser::to_map_csv(made->map.map);
  work.made = std::move(*made);
}

/// The tables of the file stand for the components that lines would make.
void take_opened_map(LaserMapWork& work, const LaserChoices& choices, const laser::Travels& travels) {
  take_made(work, opened_map(choices.opened_map, zeros_needed(work, choices), *work.parameters, travels));
  if (!work.made) return;
  const laser::ErrorMap& map = work.made->map.map;
  for (const laser::MapTable& table : map.tables)
    work.suggested.recipe.components.push_back({table.component, {choices.opened_map}, {}, 0.0, {}, {}});
  work.recipe.declared_zero = map.header.declared_zero;
}

}  // namespace

LaserMapWork laser_map(const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  LaserMapWork work;
  take_parameters(work, choices);
  if (!work.parameters) return work;
  const laser::Travels travels = travels_beside(choices.params_file, *work.parameters);
  if (!choices.opened_map.empty()) {
    take_opened_map(work, choices, travels);
  } else {
    assign_lines(work, choices, lines);
    work.recipe = full_recipe(work, choices, lines);
    if (work.refusals.empty())
      take_made(work, made_map(work.recipe, *work.parameters, travels, reader_of(choices, lines)));
  }
  take_components(work);
  return work;
}

namespace {

/// The recipe with its files where they stay: prepared ones, written now, beside the map, the others by their whole
/// path.
Result<laser::MapRecipe> kept_recipe(laser::MapRecipe recipe, const LaserChoices& choices,
                                     const std::vector<LaserLine>& lines, const fs::path& keep_in) {
  for (laser::ComponentRecipe& one : recipe.components)
    for (fs::path& file : one.files) {
      if (is_prepared(file)) {
        disc::make_folders(keep_in);
        const std::size_t line = lines_behind({one.component, {file}, {}, 0.0, {}, {}}, lines).front();
        file = keep_in / file.filename();
        ECS_DO(write_file(file, prepared_csv(choices, lines[line])));
      }
      file = disc::absolute(file);
    }
  return recipe;
}

/// As the verb would log it that makes the same map of the recipe; of a map that was opened there is none.
void log_map(const MapFiles& files, const laser::MapRecipe& recipe, const LaserChoices& choices) {
  if (!records_are_kept()) return;
  const bool by_recipe = choices.opened_map.empty();
  std::vector<std::string> inputs{choices.params_file};
  if (by_recipe) {
    inputs.push_back(files.recipe);
    for (const laser::ComponentRecipe& one : recipe.components)
      for (const fs::path& file : one.files) inputs.push_back(file.string());
  } else {
    inputs.push_back(choices.opened_map);
  }
  std::sort(inputs.begin(), inputs.end());
  inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
  std::error_code error;
  const auto whole = [&](const std::string& name) { return fs::absolute(name, error).lexically_normal().string(); };
  Json content{{"screen", "PROCESS LASER DATA"}, {"folder", fs::current_path(error).string()}};
  if (by_recipe)
    content["words"] = {"map",
                        "build",
                        whole(files.recipe),
                        "--params",
                        whole(choices.params_file),
                        "-o",
                        whole(files.map),
                        "--params-out",
                        whole(files.parameters)};
  record({.kind = "map",
          .summary = fmt::format("{} saved on the screen", fs::path(files.map).filename().string()),
          .content = one_line(content),
          .files = seen_files(inputs, {files.map, files.parameters})});
}

}  // namespace

Result<SavedMap> save_laser_map(const LaserMapWork& work, const LaserChoices& choices,
                                const std::vector<LaserLine>& lines) {
  const MapFiles files = files_of_map(choices.map_file);
  const std::string opened = choices.opened_map.empty() ? "" : read_file(choices.opened_map).value_or("");
  if (const fs::path folder = fs::path(files.map).parent_path(); !folder.empty()) disc::make_folders(folder);
  ECS_TRY(recipe, kept_recipe(work.recipe, choices, lines, files.folder));
  ECS_DO(
      write_map(files.map, work.made->map.map, files.parameters, work.made->map.parameters, work.parameters->identity));
  if (choices.opened_map.empty()) ECS_DO(write_file(files.recipe, laser::recipe_text(recipe)));
  log_map(files, recipe, choices);
  return SavedMap{files, work.csv, choices.opened_map.empty() ? recipe : laser::MapRecipe{}, opened};
}

namespace {

/// From one parameter file to another, the scope as chosen. Values that the second file has already are set again.
void note_parameters(const std::string& from, const std::string& to, const std::string& scope) {
  if (from == to && scope.empty()) return;
  const auto held = params::read_parameters(from);
  const std::string value =
      !scope.empty() || !held ? scope : params::text_of(*params::field_named(kScopeKey), held->parameters);
  note_command({"params", "set", path_word(from), fmt::format("{}={}", kScopeKey, value), "-o", path_word(to)});
}

/// The recipe that a script carries: files in the working folder are named from the recipe on.
std::string recipe_for_script(laser::MapRecipe recipe, const std::string& recipe_file) {
  const fs::path folder = disc::absolute(recipe_file).lexically_normal().parent_path();
  for (laser::ComponentRecipe& one : recipe.components)
    for (fs::path& file : one.files)
      if (const fs::path word = path_word(file.string()); word.is_relative())
        file = disc::absolute(word).lexically_normal().lexically_relative(folder);
  return laser::recipe_text(recipe);
}

/// The files of the recipe that had to be prepared, each by its verb, or as it is where no verb makes it.
void note_prepared(const SavedMap& saved, const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  const fs::path kept = disc::absolute(saved.files.folder);
  std::vector<fs::path> noted;
  for (const laser::ComponentRecipe& one : saved.recipe.components)
    for (const fs::path& file : one.files) {
      if (file.parent_path() != kept || std::find(noted.begin(), noted.end(), file) != noted.end()) continue;
      noted.push_back(file);
      std::optional<std::vector<std::string>> words;
      for (std::size_t k = 0; k < lines.size(); ++k)
        if (prepared_path(lines, k).filename() == file.filename())
          words = prepare_words(lines[k], choice_for_line(choices, lines[k]), choices.files, file.string());
      if (words)
        note_command(std::move(*words));
      else
        note_file(file.string(), read_file(file).value_or(""));
    }
}

}  // namespace

void note_saved_map(const SavedMap& saved, const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  const MapFiles& files = saved.files;
  if (choices.opened_map.empty()) {
    std::string parameters = choices.params_file;
    if (!choices.scope.empty()) {
      parameters = file_between("parameters", ".toml");
      note_parameters(choices.params_file, parameters, choices.scope);
    }
    note_prepared(saved, choices, lines);
    note_file(files.recipe, recipe_for_script(saved.recipe, files.recipe));
    note_command({"map", "build", path_word(files.recipe), "--params", path_word(parameters), "-o",
                  path_word(files.map), "--params-out", path_word(files.parameters)});
    return;
  }
  if (saved.opened != saved.csv) {
    note_remark("no command changes an opened map: this is the map made by the screen");
    note_file(files.map, saved.csv);
  } else if (path_word(choices.opened_map) != path_word(files.map)) {
    NotedCommand copy;
    copy.words = {"cp", path_word(choices.opened_map), path_word(files.map)};
    note(std::move(copy));
  }
  note_parameters(choices.params_file, files.parameters, choices.scope);
}

}  // namespace ecs::commissioning
