#include "commissioning/laser_session/curves.hpp"

#include <fmt/format.h>

#include "commissioning/plot/curves.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/map/recipe.hpp"

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

/// What the steps made of a curve. @param readings  behind the curve; empty: none
void finish(LaserCurve& out, const laser::ProcessedCurve& steps, const laser::MeasurementSet& readings) {
  out.removed_per_m = steps.level.removed.slope_per_m;
  out.removed_std_error_per_m = steps.level.slope_std_error_per_m;
  out.smoothed = steps.smooth;
  if (steps.smooth) out.band_after = laser::band_of(steps.smooth->curve);
  if (steps.smoothing_fault) out.problem = "smoothing: " + to_text(*steps.smoothing_fault);
  out.after = screen_panel(readings, steps.curve(), "after");
  out.unchanged = out.slope == laser::SlopeMethod::none && !out.smoothed;
  if (out.unchanged) out.before.title = "before and after";
}

laser::CurveSteps steps_of(const LaserCurve& curve) { return {curve.slope, curve.choice.smoothing_mm}; }

void take_one_line(LaserCurve& out, const LaserLineResult& line) {
  const auto readings = laser::processed_readings(line.chosen, line.group, steps_of(out));
  if (!readings) {
    out.problem = to_text(readings.error());
    return;
  }
  out.band_before = readings->band_before;
  out.band_after = readings->band;
  out.before = screen_panel(readings->before, readings->before_curve, "before");
  finish(out, *readings, readings->after);
}

void take_two_lines(LaserCurve& out, const LaserLineResult& first, const LaserLineResult& second) {
  const auto rotation = laser::rotation_from(*first.curve, *second.curve);
  const auto steps = rotation ? laser::processed(*rotation, steps_of(out)) : tl::unexpected(rotation.error());
  if (!steps) {
    out.problem = to_text(steps.error());
    return;
  }
  out.band_before = laser::band_of(*rotation);
  out.band_after = laser::band_of(steps->level.curve);
  out.before = screen_panel({}, *rotation, "before");
  finish(out, *steps, {});
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

LaserCurve laser_curve(Component component, std::vector<std::size_t> lines, const LaserComponentChoice& choice,
                       const LaserLineResults& results) {
  LaserCurve out;
  out.component = component;
  out.lines = std::move(lines);
  out.choice = choice;
  out.recommended = laser::default_slope(component);
  out.slope = choice.slope.value_or(out.recommended);
  for (const auto& result : results)
    if (!result->curve) out.problem = result->problem;
  for (const auto& result : results) out.left_out_of_lines += result->left_out.size();
  if (!out.problem.empty()) return out;
  if (results.size() == 1) out.left_out = results.front()->left_out;
  if (results.size() == 2)
    take_two_lines(out, *results[0], *results[1]);
  else
    take_one_line(out, *results[0]);
  return out;
}

}  // namespace ecs::commissioning
