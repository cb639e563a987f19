// Curves in a terminal: braille dots, or letters where the terminal has no braille; axes with ticks and units, a cursor
// with read-out, a part of the x range. And where in its area the curves of a chart lie: for charts, and for what is
// marked on them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/plot/figure.hpp"

namespace ecs::app {

/// How much of a panel is seen, and what is pointed at.
struct ChartView {
  std::optional<double> x_from, x_to;  ///< absent: all
  std::optional<double> cursor_x;      ///< a vertical line there, and the nearest points read out
  std::optional<double> y_from, y_to;  ///< absent: what is seen
};

/// Round numbers between `from` and `to`, at most `most` of them; empty if there is nothing between.
[[nodiscard]] std::vector<double> ticks_between(double from, double to, int most);
/// Of a tick among others so far apart: no more digits than needed.
[[nodiscard]] std::string tick_label(double value, double apart);

/// Draws the panel into `area`: title, y axis at the left, x axis below, legend in the last row.
/// Forward is a solid line with ▲, reverse a broken one with ▼ (^ and v in ASCII): they differ without colour.
void draw_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const ChartView& view = {});

/// The points nearest to an x, one per series, as text: "forward 3.200 um, reverse -1.050 um at 120.000 mm".
[[nodiscard]] std::string read_out(const PlotPanel& panel, double x);

/// Half (or twice) the range around `centre`, inside the data.
[[nodiscard]] ChartView zoomed(const PlotPanel& panel, const ChartView& view, double factor);
/// The cursor moved to the next or previous x at which a point is.
[[nodiscard]] ChartView stepped(const PlotPanel& panel, const ChartView& view, int direction);

/// The keys that every chart has: left and right move the cursor, + - 0 zoom. @return whether it was one of them
[[nodiscard]] bool on_chart_key(const Key& key, const PlotPanel& panel, ChartView& view);

constexpr int kYAxisColumns = 9;
constexpr int kRowsAroundPlot = 4;  ///< title above; axis, its numbers and the legend below

[[nodiscard]] constexpr Area plot_area(const Area& chart) {
  return {chart.row + 1, chart.column + kYAxisColumns, chart.rows - kRowsAroundPlot, chart.columns - kYAxisColumns};
}

}  // namespace ecs::app
