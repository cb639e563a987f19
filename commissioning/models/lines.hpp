// Measured lines of a data set, and how their points look: shared by pictures in files and on the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "commissioning/plot/figure.hpp"
#include "core/axis.hpp"
#include "model/data/observations.hpp"

namespace ecs::commissioning {

/// Readings of one sense along one axis with the others parked at one place, or those along one path.
struct MeasuredLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  bool rotary = false;            ///< the axes are A, B, C
  std::string path{};             ///< "circle XY"; "": along the axis
  std::vector<std::size_t> rows;  ///< canonical order of the observations
};
/// By sense, axis and parked place; then the paths.
[[nodiscard]] std::vector<MeasuredLine> measured_lines(const model::Observations& data);
/// "EX along X at Y -700"
[[nodiscard]] std::string title_of(const MeasuredLine& line);

/// Where each reading lies: the coordinate of the axis [mm, machine coordinates, or deg], on a path the place along it.
[[nodiscard]] std::vector<double> places_along(const model::Observations& data, Axis axis);
/// "X position [mm]", "angle_deg"
[[nodiscard]] std::string label_along(const model::Observations& data, const MeasuredLine& line);

/// Points without a line, by approach (1, -1, 0 unknown).
[[nodiscard]] Mark reading_mark(int approach);
/// Lines, by approach.
[[nodiscard]] Mark line_mark(int approach);

}  // namespace ecs::commissioning
