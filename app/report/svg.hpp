// Curves drawn as SVG inside a page: stacked panels on one scale, or bars. Readable without colour: forward is a solid
// line with full triangles upward, reverse a broken one with open triangles downward.
// Does not live here: which curves (report_figures.hpp), figures in files (app/plot/gnuplot.hpp).
#pragma once

#include <string>
#include <vector>

#include "app/report/markup.hpp"
#include "commissioning/plot/figure.hpp"

namespace ecs::app {

enum class SvgMark {
  forward,
  reverse,
  both,    ///< solid line, full circles
  spread,  ///< points in pairs of equal x: a grey bar from the lower to the upper
};

struct SvgSeries {
  SvgMark mark = SvgMark::both;
  std::vector<PlotPoint> points;  ///< finite
};

struct SvgPanel {
  std::string title;
  std::vector<SvgSeries> series;  ///< drawn in this order
};

/// Panels one below the other, the same scale in all of them.
struct SvgCurves {
  std::string label;  ///< for readers who do not see it
  std::string x_label;
  std::string y_label;
  std::vector<SvgPanel> panels;
};
[[nodiscard]] Markup svg_of(const SvgCurves& figure);

struct SvgBar {
  std::string name;
  double value = 0.0;
  std::string value_text;
};
/// Horizontal bars from zero, and a broken line at `level` with its name.
struct SvgBars {
  std::string label;
  std::vector<SvgBar> bars;
  double level = 0.0;  ///< 0: none
  std::string level_name;
};
[[nodiscard]] Markup svg_of(const SvgBars& figure);

/// Round numbers inside least … most, about `wanted` of them.
[[nodiscard]] std::vector<double> round_ticks(double least, double most, int wanted);

}  // namespace ecs::app
