// The files of a map: the map itself, its parameters, the recipe, what had to be prepared for it.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/map_work.hpp"
#include "commissioning/laser_session/prepared_lines.hpp"
#include "commissioning/logbook/observed.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/session/commands.hpp"
#include "laser/map/recipe.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;
constexpr const char* kScopeKey = "compensation.scope";

/// A TOML string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

std::string recipe_text(const laser::MapRecipe& recipe) {
  std::string text = "# How this map was made; `ecs map build` makes it again from the same files.\n";
  const auto word = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{} = {}\n", key, quoted(value));
  };
  word("customer", recipe.customer);
  word("engineer", recipe.engineer);
  word("date", recipe.date);
  word("machine", recipe.machine);
  word("serial_number", recipe.serial_number);
  word("remark", recipe.remark);
  for (const laser::ComponentRecipe& one : recipe.components) {
    text += fmt::format("\n[[component]]\ncode = \"{}\"\nfiles = [", name_of(one.component));
    for (std::size_t k = 0; k < one.files.size(); ++k) text += (k == 0 ? "" : ", ") + quoted(one.files[k].string());
    text += "]\n";
    if (one.slope) text += fmt::format("slope = \"{}\"\n", laser::name_of(*one.slope));
    if (one.smoothing_mm > 0.0) text += fmt::format("smoothing_mm = {}\n", shortest(one.smoothing_mm));
    if (one.increment_mm) text += fmt::format("increment_mm = {}\n", shortest(*one.increment_mm));
    for (std::size_t k = 0; k < one.exclude_runs.size(); ++k)
      text += fmt::format("{}{}", k == 0 ? "exclude_runs = [" : ", ", one.exclude_runs[k]);
    if (!one.exclude_runs.empty()) text += "]\n";
  }
  for (const laser::DeclaredZero& zero : recipe.declared_zero)
    text +=
        fmt::format("\n[[declared_zero]]\ncode = \"{}\"\nreason = {}\n", name_of(zero.component), quoted(zero.reason));
  return text;
}

/// The recipe with its files where they stay: prepared ones beside the map, the others by their whole path.
Result<laser::MapRecipe> recipe_to_keep(laser::MapRecipe recipe, const fs::path& prepared, const fs::path& keep_in) {
  for (laser::ComponentRecipe& one : recipe.components)
    for (fs::path& file : one.files) {
      std::error_code error;
      if (file.parent_path() != prepared) {
        file = fs::absolute(file, error);
        continue;
      }
      ECS_TRY(content, read_file(file));
      fs::create_directories(keep_in, error);
      ECS_DO(write_file(keep_in / file.filename(), content));
      file = fs::absolute(keep_in / file.filename(), error);
    }
  return recipe;
}

/// As the verb would log it that makes the same map of the recipe; of a map that was opened there is none.
void log_map(const MapFiles& files, const laser::MapRecipe& recipe, const LaserChoices& choices) {
  if (!logbook_is_kept()) return;
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
  LogRecord made;
  made.kind = "map";
  made.summary = fmt::format("{} saved on the screen", fs::path(files.map).filename().string());
  made.content = one_line(content);
  made.files = seen_files("input", inputs);
  for (SeenFile& file : seen_files("output", {files.map, files.parameters})) made.files.push_back(std::move(file));
  record(std::move(made));
}

}  // namespace

MapFiles files_of_map(const std::string& map_file) {
  const std::string stem = map_file.ends_with(".csv") ? map_file.substr(0, map_file.size() - 4) : map_file;
  return {map_file, stem + "-parameters.toml", stem + "-recipe.toml", stem + "-files"};
}

Result<SavedMap> save_laser_map(const LaserMapWork& work, const LaserChoices& choices, const fs::path& prepared) {
  const MapFiles files = files_of_map(choices.map_file);
  const std::string opened = choices.opened_map.empty() ? "" : read_file(choices.opened_map).value_or("");
  std::error_code error;
  if (const fs::path folder = fs::path(files.map).parent_path(); !folder.empty()) fs::create_directories(folder, error);
  ECS_TRY(recipe, recipe_to_keep(work.recipe, prepared, files.folder));
  ECS_DO(write_file(files.map, work.csv));
  if (choices.opened_map.empty()) ECS_DO(write_file(files.recipe, recipe_text(recipe)));
  if (const auto written =
          params::write_parameters(files.parameters, work.made->map.parameters, work.parameters->identity);
      !written)
    return tl::unexpected(written.error());
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
  std::error_code error;
  const fs::path folder = fs::absolute(recipe_file, error).lexically_normal().parent_path();
  for (laser::ComponentRecipe& one : recipe.components)
    for (fs::path& file : one.files)
      if (const fs::path word = path_word(file.string()); word.is_relative())
        file = fs::absolute(word, error).lexically_normal().lexically_relative(folder);
  return recipe_text(recipe);
}

/// The files of the recipe that had to be prepared, each by its verb, or as it is where no verb makes it.
void note_prepared(const SavedMap& saved, const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  std::error_code error;
  const fs::path kept = fs::absolute(saved.files.folder, error);
  std::vector<fs::path> noted;
  for (const laser::ComponentRecipe& one : saved.recipe.components)
    for (const fs::path& file : one.files) {
      if (file.parent_path() != kept || std::find(noted.begin(), noted.end(), file) != noted.end()) continue;
      noted.push_back(file);
      std::optional<std::vector<std::string>> words;
      for (std::size_t k = 0; k < lines.size(); ++k)
        if (prepared_path(lines, k, kept) == file)
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
    note_remark("no command changes a map that was opened: this is what the screen made of it");
    note_file(files.map, saved.csv);
  } else if (path_word(choices.opened_map) != path_word(files.map)) {
    NotedCommand copy;
    copy.words = {"cp", path_word(choices.opened_map), path_word(files.map)};
    note(std::move(copy));
  }
  note_parameters(choices.params_file, files.parameters, choices.scope);
}

}  // namespace ecs::commissioning
