#include "commissioning/laser_session/work.hpp"

#include <fmt/format.h>

#include "commissioning/plot/curves.hpp"
#include "laser/analysis/pipeline.hpp"

namespace ecs::commissioning {
namespace {

std::string y_label_of(Sense sense) { return fmt::format("error [{}]", is_rotation(sense) ? "µm/m" : "µm"); }

/// Names short enough for the legend of a curve beside a list.
PlotPanel screen_panel(const laser::MeasurementSet& readings, const laser::Curve& curve, const std::string& title) {
  PlotPanel panel = panel_of(readings, curve, title);
  panel.x_label = fmt::format("{} [mm]", letter_of(curve.axis));
  for (PlotSeries& series : panel.series) {
    if (series.mark == Mark::forward_reading || series.mark == Mark::reverse_reading) series.name = "runs";
    if (series.mark == Mark::forward) series.name = "forward";
    if (series.mark == Mark::reverse) series.name = "reverse";
  }
  return panel;
}

/// From one line what is done to its readings, from two to the rotation that they show, which has none.
Result<laser::ProcessedReadings> steps_of(const LaserLineResults& lines, const laser::CurveSteps& steps) {
  if (lines.size() == 1) return laser::processed_readings(lines.front()->chosen, lines.front()->group, steps);
  ECS_TRY(rotation, laser::rotation_from(*lines[0]->curve, *lines[1]->curve));
  ECS_TRY(processed, laser::processed(rotation, steps));
  laser::ProcessedReadings out{std::move(processed), {}, std::move(rotation), {}, 0.0, 0.0};
  out.band_before = laser::band_of(out.before_curve);
  out.band = laser::band_of(out.level.curve);
  return out;
}

}  // namespace

bool left_out(const LaserLineChoice& choice, const laser::MeasurementSet& set, std::size_t reading) {
  return choice.readings.contains(reading) || choice.runs.contains(set.readings[reading].run);
}

std::size_t count_left_out(const LaserLineChoice& choice, const laser::MeasurementSet& set) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < set.readings.size(); ++i) count += left_out(choice, set, i) ? 1U : 0U;
  return count;
}

LaserLineResult line_result(const LaserLine& line, const LaserLineChoice& choice) {
  LaserLineResult result;
  result.choice = choice;
  result.of = line.set;
  result.chosen = *line.set;
  result.chosen.readings.clear();
  for (const std::size_t i : line.group.readings) {
    const laser::Reading& reading = line.set->readings[i];
    if (left_out(choice, *line.set, i))
      result.left_out.push_back({laser::target_mm(reading), reading.error});
    else
      result.chosen.readings.push_back(reading);
  }
  const std::string title = name_of_line(line) + ", " + line.place;
  result.panel = {title, fmt::format("{} [mm]", letter_of(line.group.axis)), y_label_of(line.group.sense), {}};
  const auto groups = laser::groups_of(result.chosen);
  if (groups.empty()) {
    result.problem = "every reading is left out";
    return result;
  }
  result.group = groups.front();
  auto curve = laser::averaged(result.chosen, result.group);
  auto iso = laser::iso230_of(result.chosen, result.group);
  if (!curve || !iso) {
    result.problem = to_text(curve ? iso.error() : curve.error());
    return result;
  }
  result.panel = screen_panel(result.chosen, *curve, title);
  result.curve = std::move(*curve);
  result.iso = std::move(*iso);
  return result;
}

LaserCurve laser_curve(Component component, std::vector<std::size_t> lines, const laser::ComponentRecipe& choice,
                       const LaserLineResults& results) {
  LaserCurve out;
  out.component = component;
  out.lines = std::move(lines);
  out.choice = choice;
  out.recommended = laser::default_slope(component);
  out.slope = choice.slope.value_or(out.recommended);
  for (const auto& result : results) {
    if (!result->curve) out.problem = result->problem;
    out.left_out_of_lines += result->left_out.size();
  }
  if (!out.problem.empty()) return out;
  if (results.size() == 1) out.left_out = results.front()->left_out;
  auto steps = steps_of(results, {out.slope, choice.smoothing_mm});
  if (!steps) {
    out.problem = to_text(steps.error());
    return out;
  }
  out.removed_per_m = steps->level.removed.slope_per_m;
  out.band_before = steps->band_before;
  out.band_after = steps->smooth ? laser::band_of(steps->smooth->curve) : steps->band;
  if (steps->smoothing_fault) out.problem = "smoothing: " + to_text(*steps->smoothing_fault);
  out.unchanged = out.slope == laser::SlopeMethod::none && !steps->smooth;
  out.before = screen_panel(steps->before, steps->before_curve, out.unchanged ? "before and after" : "before");
  out.after = screen_panel(steps->after, steps->curve(), "after");
  out.smoothed = std::move(steps->smooth);
  return out;
}

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
std::vector<WantedCurve> wanted_curves(const LaserWork& work) {
  std::vector<WantedCurve> wanted;
  for (const laser::ComponentRecipe& one : work.map.suggested.recipe.components)
    if (auto lines = lines_behind(one, work.lines); !lines.empty()) wanted.push_back({one.component, std::move(lines)});
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

std::vector<LaserCurve> curves_of(const LaserWork& work, const LaserWork* before) {
  std::vector<LaserCurve> curves;
  for (WantedCurve& one : wanted_curves(work)) {
    const laser::ComponentRecipe choice = laser::settings_of(work.choices.recipe, one.component);
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

LaserWorkPtr worked_out(const LaserChoices& choices, const LaserWorkPtr& before, bool with_map, JobControl& control) {
  auto work = std::make_shared<LaserWork>();
  work->choices = choices;
  bool changed = true;
  work->files = read_files(choices, before.get(), changed, control);
  work->lines = changed || !before ? laser_lines(work->files) : before->lines;
  work->results = results_of(*work, before.get());
  work->map_current = with_map && !control.cancelled;
  if (work->map_current)
    work->map = laser_map(choices, work->lines);
  else if (before)
    work->map = before->map;
  if (!work->map_current && changed) {
    work->map.suggested = {};
    work->map.parameters.reset();
  }
  work->curves = curves_of(*work, before.get());
  return work;
}

}  // namespace ecs::commissioning
