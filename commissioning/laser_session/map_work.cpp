#include "commissioning/laser_session/map_work.hpp"

#include <algorithm>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/date.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/prepared_lines.hpp"
#include "commissioning/maps/findings.hpp"
#include "laser/map/csv.hpp"
#include "laser/writers/measurement_writer.hpp"

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

}  // namespace ecs::commissioning
