// Curves of one measurement, before and after compensation on one scale.
#include <fmt/format.h>

#include "app/report/sections.hpp"
#include "app/report/svg.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

PlotPanel phase_panel(const MeasuredPhase& phase, std::string_view name, int decimals, std::string_view unit) {
  const laser::Curve& curve = phase.readings.level.curve;
  PlotPanel panel{fmt::format("{}: band {}", name, quantity_text(phase.readings.band, decimals, unit)),
                  fmt::format("{} position [mm]", letter_of(curve.axis)),
                  fmt::format("error [{}]", unit_text(unit)),
                  {}};
  panel.series.push_back(spread_series(phase.readings.after));
  if (curve.approach_known) panel.series.push_back(mean_series(curve, Approach::reverse));
  panel.series.push_back(mean_series(curve, Approach::forward));
  return panel;
}

}  // namespace

Markup figure_of_row(const TableRow& row) {
  const int decimals = decimals_of(row);
  const auto unit = laser::unit_of(row.planned.sense);
  PlotFigure figure{fmt::format("{}: error curves before and after compensation", row.planned.title), {}, 1, true};
  if (row.before) figure.panels.push_back(phase_panel(*row.before, "before", decimals, unit));
  if (row.after) figure.panels.push_back(phase_panel(*row.after, "after", decimals, unit));
  return element("figure", inline_svg(figure)) + Markup::literal("\n");
}

}  // namespace ecs::app
