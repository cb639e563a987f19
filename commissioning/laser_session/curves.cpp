#include "commissioning/laser_session/curves.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "commissioning/measurements/levelling.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

/// Range of the means of a curve; 0 where there are none.
double band_of(const laser::Curve& curve) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const laser::CurvePoint& point : curve.points)
    for (const std::optional<double>& value : {point.forward, point.reverse}) {
      if (!value) continue;
      lowest = std::min(lowest, *value);
      highest = std::max(highest, *value);
    }
  return highest >= lowest ? highest - lowest : 0.0;
}

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

Result<laser::Smoothed> smoothed_over(const laser::Curve& curve, double window_mm) {
  laser::Smoothing how;
  how.window_mm = window_mm;
  return laser::smoothed(curve, how);
}

void take_level(LaserCurve& out, const laser::Levelled& level) {
  out.removed_per_m = level.removed.slope_per_m;
  out.removed_std_error_per_m = level.slope_std_error_per_m;
}

/// Smooths if that is chosen and draws what comes out. @param readings  behind the curve; empty: none
void finish(LaserCurve& out, const laser::Curve& level, const laser::MeasurementSet& readings) {
  if (out.choice.smoothing_mm > 0.0) {
    auto smooth = smoothed_over(level, out.choice.smoothing_mm);
    if (!smooth) {
      out.problem = "smoothing: " + to_text(smooth.error());
    } else {
      out.smoothed = std::move(*smooth);
      out.band_after = band_of(out.smoothed->curve);
    }
  }
  out.after = screen_panel(readings, out.smoothed ? out.smoothed->curve : level, "after");
  out.unchanged = out.slope == laser::SlopeMethod::none && !out.smoothed;
  if (out.unchanged) out.before.title = "before and after";
}

void take_one_line(LaserCurve& out, const LaserLineResult& line) {
  const auto readings = levelled_readings(line.chosen, line.group, out.slope);
  if (!readings) {
    out.problem = to_text(readings.error());
    return;
  }
  take_level(out, readings->level);
  out.band_before = readings->band_before;
  out.band_after = readings->band;
  out.before = screen_panel(readings->before, readings->before_curve, "before");
  finish(out, readings->level.curve, readings->after);
}

void take_two_lines(LaserCurve& out, const LaserLineResult& first, const LaserLineResult& second) {
  const auto rotation = laser::rotation_from(*first.curve, *second.curve);
  const auto level = rotation ? laser::levelled(*rotation, out.slope) : tl::unexpected(rotation.error());
  if (!level) {
    out.problem = to_text(level.error());
    return;
  }
  take_level(out, *level);
  out.band_before = band_of(*rotation);
  out.band_after = band_of(level->curve);
  out.before = screen_panel({}, *rotation, "before");
  finish(out, level->curve, {});
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

}  // namespace ecs::app
