// Polar plots of radial deviations: as a figure (thesis figure 7.22) and in characters.
#pragma once

#include <string>

#include "commissioning/plot/figure.hpp"
#include "laser/standards/circle.hpp"

namespace ecs::commissioning {

/// The first pass of each direction about the least squares circle of both together, deviations from it magnified, with
/// rings at round deviations.
[[nodiscard]] PlotFigure polar_figure(const laser::CircleTest& test, const laser::CircleValues& values);

/// The same in 31 rows of 61 characters: + counter-clockwise, o clockwise, # both, . least squares circle.
[[nodiscard]] std::string polar_text(const laser::CircleValues& values);

}  // namespace ecs::commissioning
