#include "commissioning/laser_session/work.hpp"

namespace ecs::commissioning {
namespace {

/// Files that did not change are not read again.
std::vector<LaserFile> read_files(const LaserChoices& choices, const LaserWork* before, bool& changed,
                                  JobControl& control) {
  std::vector<LaserFile> files;
  changed = before == nullptr || before->files.size() != choices.files.size();
  for (std::size_t k = 0; k < choices.files.size() && !control.cancelled; ++k) {
    const LaserFileChoice& choice = choices.files[k];
    const LaserFile* known = nullptr;
    if (before != nullptr)
      for (const LaserFile& file : before->files)
        if (file.choice.path == choice.path && file.stamp == stamp_of(choice.path) &&
            given_answers(file.choice.answers) == given_answers(choice.answers))
          known = &file;
    changed = changed || known == nullptr || known != &before->files[k];
    changed = changed || (known != nullptr && known->choice.places != choice.places);
    files.push_back(known != nullptr ? *known : read_laser_file(choice));
    files.back().choice = choice;
    control.part = static_cast<double>(k + 1) / static_cast<double>(choices.files.size());
  }
  return files;
}

LaserLineResults results_of(const LaserWork& work, const LaserWork* before) {
  LaserLineResults results;
  for (const LaserLine& line : work.lines) {
    const LaserLineChoice choice = choice_for_line(work.choices, line);
    std::shared_ptr<const LaserLineResult> known;
    if (before != nullptr)
      for (const auto& result : before->results)
        if (result->of == line.set && result->choice == choice) known = result;
    results.push_back(known ? known : std::make_shared<const LaserLineResult>(line_result(line, choice)));
  }
  return results;
}

/// Curves of the components of the map, or of every line where no parameters say which they are.
struct WantedCurve {
  Component component = Component::EXX;
  std::vector<std::size_t> lines;
};
std::vector<WantedCurve> wanted_curves(const LaserWork& work, const std::filesystem::path& folder) {
  std::vector<WantedCurve> wanted;
  for (const laser::ComponentRecipe& one : work.map.assignment.recipe.components)
    if (auto lines = lines_behind(one, work.lines, folder); !lines.empty())
      wanted.push_back({one.component, std::move(lines)});
  if (work.map.parameters) return wanted;
  for (std::size_t k = 0; k < work.lines.size(); ++k) wanted.push_back({work.lines[k].component, {k}});
  return wanted;
}

bool same_lines(const LaserCurve& curve, const LaserLineResults& then, const std::vector<std::size_t>& lines,
                const LaserLineResults& now) {
  if (curve.lines.size() != lines.size()) return false;
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (curve.lines[k] >= then.size() || then[curve.lines[k]] != now[lines[k]]) return false;
  return true;
}

std::vector<LaserCurve> curves_of(const LaserWork& work, const LaserWork* before, const std::filesystem::path& folder) {
  std::vector<LaserCurve> curves;
  for (WantedCurve& one : wanted_curves(work, folder)) {
    const LaserComponentChoice choice = choice_for_component(work.choices, one.component);
    const LaserCurve* known = nullptr;
    if (before != nullptr)
      for (const LaserCurve& curve : before->curves)
        if (curve.component == one.component && curve.choice == choice &&
            same_lines(curve, before->results, one.lines, work.results))
          known = &curve;
    if (known != nullptr) {
      curves.push_back(*known);
      curves.back().lines = one.lines;
      continue;
    }
    LaserLineResults results;
    for (const std::size_t line : one.lines) results.push_back(work.results[line]);
    curves.push_back(laser_curve(one.component, std::move(one.lines), choice, results));
  }
  return curves;
}

}  // namespace

LaserWorkPtr worked_out(const LaserChoices& choices, const LaserWorkPtr& before, const std::filesystem::path& folder,
                        bool with_map, JobControl& control) {
  auto work = std::make_shared<LaserWork>();
  work->choices = choices;
  bool changed = true;
  work->files = read_files(choices, before.get(), changed, control);
  work->lines = changed || !before ? laser_lines(work->files) : before->lines;
  work->results = results_of(*work, before.get());
  const LaserAssignment assignment = before ? before->map.assignment : LaserAssignment{};
  if (before) work->map = before->map;
  if (with_map && !control.cancelled) {
    take_parameters(work->map, choices);
    assign_lines(work->map, choices, work->lines, assignment, folder);
  } else if (changed) {
    work->map.assignment = {};
    work->map.parameters.reset();
  }
  work->curves = curves_of(*work, before.get(), folder);
  if (with_map && !control.cancelled) build_laser_map(work->map, choices, work->lines, folder);
  work->map_current = with_map && !control.cancelled;
  return work;
}

}  // namespace ecs::commissioning
