// A figure drawn as SVG inside a page: stacked panels on one scale, or bars. Readable without colour: forward is a
// solid line with full triangles upward, reverse a broken one with open triangles downward. Does not live here: which
// curves (curve_sections.cpp), figures in files (app/plot/gnuplot.hpp).
#pragma once

#include <vector>

#include "app/names/commissioning.hpp"
#include "commissioning/plot/figure.hpp"
#include "modules/report/markup.hpp"

namespace ecs::app {

/// Panels one below the other, the same scale in all of them; the axes' labels are those of the last. A figure with
/// names in place of numbers is drawn as horizontal bars, a second series in front of the first, with a broken line at
/// its level. One panel of equal units is drawn square, lines without marks.
[[nodiscard]] Markup inline_svg(const PlotFigure& figure);

/// Round numbers inside least … most, about `wanted` of them.
[[nodiscard]] std::vector<double> round_ticks(double least, double most, int wanted);

}  // namespace ecs::app
