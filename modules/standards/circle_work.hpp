// A circular test from its file to its causes, for the verb and for the report; its polar plot as a figure (thesis
// figure 7.22) and in characters. Does not live here: the values of ISO 230-4 (laser/standards/circle.hpp), how causes
// are found (circle_diagnosis.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "commissioning/plot/figure.hpp"
#include "laser/standards/circle.hpp"
#include "modules/standards/circle_diagnosis.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

struct CircleWork {
  std::filesystem::path file;
  laser::CircleTest test;
  laser::CircleValues values;
  model::CircleDiagnosis diagnosis;
};

/// @param machine  for the pitches of its axes; null: none are known
/// Refused: a file that is no circular test, a plane with an axis that the machine does not have, too few readings.
[[nodiscard]] Result<CircleWork> circle_work(const std::filesystem::path& file, const params::Machine* machine);

/// 1, 2 or 5 times a power of ten, at most `value`, above 0.
[[nodiscard]] double round_below(double value);
/// Of a polar plot.
[[nodiscard]] PlotPoint polar_point(double radius, double angle_deg);
[[nodiscard]] PlotSeries ring(std::string name, Mark mark, double radius);

/// The first pass of each direction about the least squares circle of both together, deviations from it magnified, with
/// rings at round deviations.
[[nodiscard]] PlotFigure polar_figure(const laser::CircleTest& test, const laser::CircleValues& values);

/// The same in 31 rows of 61 characters: + counter-clockwise, o clockwise, # both, . least squares circle.
[[nodiscard]] std::string polar_text(const laser::CircleValues& values);

}  // namespace ecs::commissioning
