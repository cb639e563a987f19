// Where in its area the curves of a chart lie, and the range of numbers that they span; for charts and for what is
// marked on them. Does not live here: drawing (chart.hpp).
#pragma once

#include <algorithm>
#include <limits>

#include "app/ui/cells.hpp"

namespace ecs::app {

struct Range {
  double from = std::numeric_limits<double>::infinity();
  double to = -std::numeric_limits<double>::infinity();
  void take(double value) {
    from = std::min(from, value);
    to = std::max(to, value);
  }
  [[nodiscard]] bool empty() const { return from > to; }
  [[nodiscard]] double width() const { return to - from; }
  [[nodiscard]] bool has(double value) const { return value >= from && value <= to; }
  /// Where it lies, 0 … 1.
  [[nodiscard]] double part(double value) const { return (value - from) / width(); }
};

constexpr int kYAxisColumns = 9;
constexpr int kRowsAroundPlot = 4;  ///< title above; axis, its numbers and the legend below

[[nodiscard]] constexpr Area plot_area(const Area& chart) {
  return {chart.row + 1, chart.column + kYAxisColumns, chart.rows - kRowsAroundPlot, chart.columns - kYAxisColumns};
}

}  // namespace ecs::app
