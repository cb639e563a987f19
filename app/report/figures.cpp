// Curves of one measurement, before and after compensation on one scale.
#include <algorithm>

#include <fmt/format.h>

#include "app/report/sections.hpp"
#include "app/report/svg.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

/// From the least to the greatest reading at each target.
SvgSeries spread_of(const laser::MeasurementSet& set) {
  SvgSeries series{SvgMark::spread, {}};
  const auto groups = laser::groups_of(set);
  if (groups.empty()) return series;
  for (const auto& target : laser::targets_of(set, groups.front(), laser::target_tolerance_mm(set, groups.front()))) {
    std::vector<double> all = target.forward;
    all.insert(all.end(), target.reverse.begin(), target.reverse.end());
    if (all.empty()) all = target.undirected;
    if (all.empty()) continue;
    const auto [least, most] = std::minmax_element(all.begin(), all.end());
    series.points.push_back({target.position_mm, *least});
    series.points.push_back({target.position_mm, *most});
  }
  return series;
}

SvgSeries means_of(const laser::Curve& curve, bool forward) {
  SvgSeries series{forward ? SvgMark::forward : SvgMark::reverse, {}};
  if (!curve.approach_known) series.mark = SvgMark::both;
  for (const laser::CurvePoint& point : curve.points)
    if (const auto& value = forward ? point.forward : point.reverse)
      series.points.push_back({point.position_mm, *value});
  return series;
}

SvgPanel panel_of(const MeasuredPhase& phase, std::string_view name, int decimals, std::string_view unit) {
  const laser::Curve& curve = phase.readings.level.curve;
  SvgPanel panel{fmt::format("{}: band {}", name, quantity_text(phase.readings.band, decimals, unit)), {}};
  panel.series.push_back(spread_of(phase.readings.after));
  if (curve.approach_known) panel.series.push_back(means_of(curve, false));
  panel.series.push_back(means_of(curve, true));
  return panel;
}

}  // namespace

Markup figure_of_row(const TableRow& row) {
  const int decimals = decimals_of(row);
  const auto unit = laser::unit_of(row.planned.sense);
  SvgCurves figure{fmt::format("{}: error curves before and after compensation", row.planned.title),
                   fmt::format("{} position [mm]", letter_of(row.planned.axis)),
                   fmt::format("error [{}]", unit_text(unit)),
                   {}};
  if (row.before) figure.panels.push_back(panel_of(*row.before, "before", decimals, unit));
  if (row.after) figure.panels.push_back(panel_of(*row.after, "after", decimals, unit));
  return element("figure", svg_of(figure)) + Markup::literal("\n");
}

}  // namespace ecs::app
