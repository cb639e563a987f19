// Measured lines of a data set, and how their points look: shared by pictures in files and on the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "commissioning/plot/figure.hpp"
#include "core/axis.hpp"
#include "model/data/observations.hpp"

namespace ecs::commissioning {

/// Readings of one sense along one axis with the others parked at one place.
struct MeasuredLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  bool rotary = false;            ///< the axes are A, B, C
  std::vector<std::size_t> rows;  ///< canonical order of the observations
};
/// By sense, axis and parked place.
[[nodiscard]] std::vector<MeasuredLine> measured_lines(const model::Observations& data);
/// "EX along X at Y -700"
[[nodiscard]] std::string title_of(const MeasuredLine& line);

/// Points without a line, by approach (1, -1, 0 unknown).
[[nodiscard]] Mark reading_mark(int approach);
/// Lines, by approach.
[[nodiscard]] Mark line_mark(int approach);

}  // namespace ecs::commissioning
