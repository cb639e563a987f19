// Where in its area the curves of a chart lie; for charts and for what is marked on them.
#pragma once

#include "app/ui/cells.hpp"

namespace ecs::app {

constexpr int kYAxisColumns = 9;
constexpr int kRowsAroundPlot = 4;  ///< title above; axis, its numbers and the legend below

[[nodiscard]] constexpr Area plot_area(const Area& chart) {
  return {chart.row + 1, chart.column + kYAxisColumns, chart.rows - kRowsAroundPlot, chart.columns - kYAxisColumns};
}

}  // namespace ecs::app
