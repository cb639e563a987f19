// The files of a map: the map itself, its parameters, the recipe, what had to be prepared for it.
#include "commissioning/laser_session/map.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/records.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/recipe.hpp"
#include "laser/writers/measurement_writer.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {

namespace fs = std::filesystem;

LaserLineChoice choice_for_line(const LaserChoices& choices, const LaserLine& line) {
  const auto found = choices.lines.find(line.key);
  return found == choices.lines.end() ? LaserLineChoice{} : found->second;
}

LaserComponentChoice choice_for_component(const LaserChoices& choices, Component component) {
  const auto found = choices.components.find(std::string(name_of(component)));
  return found == choices.components.end() ? LaserComponentChoice{} : found->second;
}

fs::path prepared_path(const std::vector<LaserLine>& lines, std::size_t at, const fs::path& folder) {
  const std::string stem = fs::path(lines[at].files.front()).stem().string();
  return folder / fmt::format("{}_line{}.csv", stem, at + 1);
}

namespace {

bool is_compensated(const LaserLine& line) { return line.group.compensated.value_or(false); }

/// The file that a map names for a line: its own where that says all of it.
fs::path source_of(const LaserChoices& choices, const std::vector<LaserLine>& lines, std::size_t at,
                   const fs::path& folder) {
  const bool as_it_is = lines[at].whole_file && choice_for_line(choices, lines[at]).readings.empty();
  return as_it_is ? fs::path(lines[at].files.front()) : prepared_path(lines, at, folder);
}

Result<void> prepare(const LaserChoices& choices, const std::vector<LaserLine>& lines, std::size_t at,
                     const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  const std::string csv = laser::to_csv(prepared_set(lines[at], choice_for_line(choices, lines[at])));
  const fs::path path = prepared_path(lines, at, folder);
  if (const auto there = read_file(path); there && *there == csv) return {};
  return write_file(path, csv);
}

std::string from_lines(const LaserAssignment& assignment, Component component) {
  std::vector<std::string> names;
  for (const laser::ComponentRecipe& one : assignment.recipe.components)
    if (one.component == component)
      for (const fs::path& file : one.files)
        if (names.empty() || names.back() != file.filename()) names.push_back(file.filename().string());
  return fmt::format("{}", fmt::join(names, " and "));
}

/// Why the lines that measure a curve are not used for it; empty: there are none.
std::string why_unused(const LaserAssignment& assignment, Component component) {
  if (is_squareness(component)) return {};
  const std::string measured =
      fmt::format("({} along {}): ", name_of(sense_of(component)), letter_of(moving_axis(component)));
  std::vector<std::string> reasons;
  for (const std::string& unused : assignment.unused)
    if (const std::size_t at = unused.find(measured); at != std::string::npos)
      reasons.push_back(unused.substr(at + measured.size()));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

LaserComponent state_of(const LaserMapWork& work, Component component) {
  LaserComponent out{component, ComponentState::missing, {}};
  for (const laser::DeclaredZero& zero : work.recipe.declared_zero)
    if (zero.component == component) return {component, ComponentState::zero, zero.reason};
  const std::string files = from_lines(work.assignment, component);
  const std::string code = std::string(name_of(component)) + ":";
  for (const std::string& refusal : work.refusals)
    if (!files.empty() && refusal.find(code) != std::string::npos) return {component, ComponentState::refused, refusal};
  if (!files.empty()) return {component, ComponentState::present, files};
  const double held = is_squareness(component) ? squareness_um_per_m(work.parameters->parameters, component) : 0.0;
  if (held != 0.0)
    return {component, ComponentState::in_parameters, fmt::format("{:.2f} um/m in the parameters", held)};
  out.detail = why_unused(work.assignment, component);
  return out;
}

void take_components(LaserMapWork& work) {
  const ComponentSet needed = components_needed(work.parameters->parameters);
  for (std::size_t k = 0; k < kComponents; ++k)
    if (needed.contains(static_cast<Component>(k)))
      work.components.push_back(state_of(work, static_cast<Component>(k)));
}

std::vector<laser::DeclaredZero> zeros_in(const LaserChoices& choices) {
  std::vector<laser::DeclaredZero> zeros;
  for (const auto& [code, choice] : choices.components)
    if (const auto component = component_of(code); component && !choice.zero_reason.empty())
      zeros.push_back({*component, choice.zero_reason});
  return zeros;
}

/// What the recipe says besides files: slope, smoothing, increments, runs left out, zeros.
laser::MapRecipe full_recipe(const LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines,
                             const fs::path& folder, std::vector<std::string>& refusals) {
  laser::MapRecipe recipe = work.assignment.recipe;
  std::erase_if(recipe.components, [&](const laser::ComponentRecipe& one) {
    return !choice_for_component(choices, one.component).zero_reason.empty();
  });
  for (laser::ComponentRecipe& one : recipe.components) {
    const LaserComponentChoice choice = choice_for_component(choices, one.component);
    one.slope = choice.slope;
    one.smoothing_mm = choice.smoothing_mm;
    one.increment_mm = choice.increment_mm;
    const auto behind = lines_behind(one, lines, folder);
    for (std::size_t k = 0; k < std::min(behind.size(), one.files.size()); ++k) {
      const LaserLine& line = lines[behind[k]];
      const LaserLineChoice left = choice_for_line(choices, line);
      const bool prepared = one.files[k].parent_path() == folder;
      if (left.runs.empty() && !prepared) continue;
      if (one.files.size() == 1 && !prepared) {
        for (const auto& [run, reason] : left.runs) one.exclude_runs.push_back(run);
        continue;
      }
      one.files[k] = prepared_path(lines, behind[k], folder);
      if (const auto done = prepare(choices, lines, behind[k], folder); !done)
        refusals.push_back(to_text(done.error()));
    }
  }
  recipe.declared_zero = zeros_in(choices);
  return recipe;
}

void take_header(LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines) {
  const LaserHeaderChoice header = header_with_files(choices.header, lines);
  work.recipe.customer = header.customer;
  work.recipe.engineer = header.engineer;
  work.recipe.date = header.date;
  work.recipe.machine = choices.header.machine;
  work.recipe.serial_number = choices.header.serial_number;
  work.recipe.remark = choices.header.remarks;
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

/// The first date of the files that is one; else today, where no file is dated in any form.
std::string date_of(const std::vector<LaserLine>& lines) {
  bool dated = false;
  for (const LaserLine& line : lines)
    for (const char* key : {"date", "Date"}) {
      std::string date = laser::metadata_value(*line.set, key).value_or("");
      if (is_iso_date(date)) return date;
      dated = dated || !date.empty();
    }
  return dated ? "" : fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)));
}

}  // namespace

LaserHeaderChoice header_with_files(const LaserHeaderChoice& chosen, const std::vector<LaserLine>& lines) {
  LaserHeaderChoice header = chosen;
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

void take_parameters(LaserMapWork& work, const LaserChoices& choices) {
  work.parameters.reset();
  work.parameters_problem.clear();
  if (choices.params_file.empty()) return;
  auto read = params::read_whole_parameters(choices.params_file);
  if (!read) {
    work.parameters_problem = to_text(read.error());
    return;
  }
  if (choices.scope == "linear") read->parameters.scope = Scope::linear;
  if (choices.scope == "planar") read->parameters.scope = Scope::planar;
  if (choices.scope == "volumetric") read->parameters.scope = Scope::volumetric;
  work.parameters = std::move(*read);
}

void assign_lines(LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines,
                  const LaserAssignment& before, const fs::path& folder) {
  work.assignment = {};
  if (!work.parameters) return;
  std::vector<fs::path> files;
  std::string made_from = params::parameters_toml(work.parameters->parameters);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (is_compensated(lines[k])) continue;
    files.push_back(source_of(choices, lines, k, folder));
    made_from += fmt::format("{}\n{}\n", files.back().string(), lines[k].key);
    if (files.back().parent_path() != folder) continue;
    if (const auto done = prepare(choices, lines, k, folder); !done) work.assignment.problem = to_text(done.error());
  }
  if (before.made_from == made_from && work.assignment.problem.empty()) {
    work.assignment = before;
    return;
  }
  work.assignment.made_from = made_from;
  auto suggested = laser::suggest_recipe(files, work.parameters->parameters);
  if (!suggested) {
    work.assignment.problem = to_text(suggested.error());
    return;
  }
  work.assignment.recipe = std::move(suggested->recipe);
  std::stable_sort(work.assignment.recipe.components.begin(), work.assignment.recipe.components.end(),
                   [](const auto& a, const auto& b) { return a.component < b.component; });
  work.assignment.unused = std::move(suggested->unused);
  for (const LaserLine& line : lines)
    if (is_compensated(line))
      work.assignment.unused.push_back(name_of_line(line) + ": measured with compensation active");
}

std::vector<std::size_t> lines_behind(const laser::ComponentRecipe& component, const std::vector<LaserLine>& lines,
                                      const fs::path& folder) {
  std::vector<std::size_t> behind;
  for (const fs::path& file : component.files)
    for (std::size_t k = 0; k < lines.size(); ++k)
      if (!is_compensated(lines[k]) && ((lines[k].whole_file && fs::path(lines[k].files.front()) == file) ||
                                        prepared_path(lines, k, folder) == file)) {
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
  work.recipe = {};
  work.assignment = {};
  take_made(work, opened_map(choices.opened_map, zeros_in(choices), *work.parameters, travels));
  if (!work.made) return;
  const laser::ErrorMap& map = work.made->map.map;
  for (const laser::MapTable& table : map.tables)
    work.assignment.recipe.components.push_back({table.component, {choices.opened_map}, {}, 0.0, {}, {}});
  work.recipe.declared_zero = map.header.declared_zero;
}

}  // namespace

void build_laser_map(LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines,
                     const fs::path& folder) {
  work.made.reset();
  work.refusals.clear();
  work.components.clear();
  work.csv.clear();
  if (!work.parameters) return;
  const laser::Travels travels = travels_beside(choices.params_file, *work.parameters);
  if (!choices.opened_map.empty()) {
    take_opened_map(work, choices, travels);
  } else {
    if (!work.assignment.problem.empty()) work.refusals.push_back(work.assignment.problem);
    work.recipe = full_recipe(work, choices, lines, folder, work.refusals);
    take_header(work, choices, lines);
    if (work.refusals.empty()) take_made(work, made_map(work.recipe, *work.parameters, travels));
  }
  take_components(work);
}

namespace {

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
