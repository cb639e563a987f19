// Figures of measurements and maps: error curves with their readings, before and after, tables of compensation.
#pragma once

#include <optional>
#include <string>

#include "commissioning/plot/figure.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/map/error_map.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {

/// The means of one approach as a line; of both where the curve knows no approach.
[[nodiscard]] PlotSeries mean_series(const laser::Curve& curve, Approach approach);

/// From the least to the greatest reading at each target of the first line in the set.
[[nodiscard]] PlotSeries spread_series(const laser::MeasurementSet& set);

/// Means of the curve as lines, the readings of its group in `set` as thin points behind them.
[[nodiscard]] PlotPanel panel_of(const laser::MeasurementSet& set, const laser::Curve& curve, const std::string& title);

/// The tables of a map, a panel for each component; one component alone if it is given.
[[nodiscard]] PlotFigure figure_of(const laser::ErrorMap& map, std::optional<Component> only, const std::string& title);

}  // namespace ecs::commissioning
