// A figure as data: panels with series of points and what each series stands for.
// Does not live here: drawing it (gnuplot.hpp), what is shown (curves.hpp).
#pragma once

#include <string>
#include <vector>

namespace ecs::app {

/// How a series looks; forward and reverse differ in shape and dash, not by colour alone.
enum class Mark {
  forward,          ///< solid line, triangles upward
  reverse,          ///< dashed line, triangles downward
  both,             ///< solid line, circles
  forward_reading,  ///< small open triangles upward, no line
  reverse_reading,  ///< small open triangles downward, no line
  reading,          ///< small open circles, no line
  bar,              ///< a filled bar from zero
  level,            ///< a thick dashed line without marks, such as a limit
};

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

struct PlotSeries {
  std::string name;  ///< in the key
  Mark mark = Mark::both;
  std::vector<PlotPoint> points;  ///< finite
};

struct PlotPanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;      ///< drawn in this order
  std::vector<std::string> x_names{};  ///< words at 0, 1, 2 … in place of numbers; empty: numbers
};

struct PlotFigure {
  std::string title;
  std::vector<PlotPanel> panels;  ///< row by row
  int columns = 1;
  bool same_scale = true;  ///< every panel has the same axes, so that they can be compared by eye
};

}  // namespace ecs::app
