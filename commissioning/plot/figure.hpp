// A figure as data: panels with series of points and what each series shows. gnuplot (app/plot/gnuplot.hpp), the
// report's inline SVG (modules/report/page.hpp) and the terminal chart (app/ui/chart.hpp) draw the same figure.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "base/outcome.hpp"

namespace ecs::commissioning {

/// How a series looks; forward and reverse differ in shape and dash, not by colour alone.
enum class Mark {
  forward,          ///< solid line, triangles upward
  reverse,          ///< dashed line, triangles downward
  both,             ///< solid line, circles
  forward_reading,  ///< small open triangles upward, no line
  reverse_reading,  ///< small open triangles downward, no line
  reading,          ///< small open circles, no line
  forward_value,    ///< filled diamonds, no line
  reverse_value,    ///< open diamonds, no line
  value,            ///< filled circles, no line
  spread,           ///< points in pairs of equal x: a grey bar from the lower to the upper
  bar,              ///< a filled bar from zero; that of a later series in front, half as high
  level,            ///< a thick dashed line without marks, such as a limit
  wire,             ///< points in pairs: a thin grey stroke from the one to the other
  bent_wire,        ///< the same, strong
  arrow,            ///< the same with a head at the second point
  label,            ///< the labels of the series, at the points
};

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

struct PlotSeries {
  std::string name;  ///< in the key
  Mark mark = Mark::both;
  std::vector<PlotPoint> points;      ///< finite
  std::vector<std::string> labels{};  ///< beside the bars of a report, at Mark::label; else none
  double longest_gap = std::numeric_limits<double>::infinity();  ///< of x between two points that a line joins
};

struct PlotPanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;      ///< drawn in this order
  std::vector<std::string> x_names{};  ///< words at 0, 1, 2 … in place of numbers; empty: numbers
  bool drawing = false;                ///< no axes, both directions of the same scale
  bool equal_units = false;            ///< with axes, a unit as long in x as in y
};

struct PlotFigure {
  std::string title;
  std::vector<PlotPanel> panels;  ///< row by row
  int columns = 1;
  bool same_scale = true;  ///< every panel has the same axes, so that they can be compared by eye
};

/// The range of numbers that points span along one axis; empty until it takes the first.
struct PlotRange {
  double from = std::numeric_limits<double>::infinity();
  double to = -std::numeric_limits<double>::infinity();

  void take(double value) {
    from = std::min(from, value);
    to = std::max(to, value);
  }
  /// Wider at both ends by a share of its width; by 1 where all numbers are the same, and [-1, 1] where there are none.
  void pad(double share) {
    if (empty()) from = to = 0.0;
    const double by = to > from ? share * width() : 1.0;
    from -= by;
    to += by;
  }
  [[nodiscard]] bool empty() const { return from > to; }
  [[nodiscard]] double width() const { return to - from; }
  [[nodiscard]] bool has(double value) const { return value >= from && value <= to; }
  /// Where it lies, 0 … 1.
  [[nodiscard]] double part(double value) const { return (value - from) / width(); }
};

struct PlotRanges {
  PlotRange x;
  PlotRange y;
  void take(const PlotPanel& panel) {
    for (const PlotSeries& series : panel.series)
      for (const PlotPoint& point : series.points) {
        x.take(point.x);
        y.take(point.y);
      }
  }
  void take(const PlotFigure& figure) {
    for (const PlotPanel& panel : figure.panels) take(panel);
  }
};

/// An answer with its picture.
struct DrawnOutcome {
  Outcome outcome;
  PlotFigure figure;
};

}  // namespace ecs::commissioning
