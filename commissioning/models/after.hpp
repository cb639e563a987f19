// What the unit would leave of measured errors, by direction, and what it did leave when measured again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// Errors of one sense while one axis moved in one direction.
struct AfterDirection {
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  int approach = 0;
  double now_um = 0.0;                ///< rms of the readings
  double predicted_um = 0.0;          ///< rms with all that the unit can carry taken away, noise included
  std::optional<double> achieved_um;  ///< rms of the readings taken afterwards
  std::size_t readings = 0;           ///< before
  std::size_t readings_after = 0;     ///< measured again
  std::string path{};                 ///< "circle XY": of readings along a path, by its first axis above; else ""
  std::string axes{};                 ///< that move along the path
};

/// @param fit  of the model to `before`
/// @param after  readings taken with the unit compensating; empty: none were
[[nodiscard]] std::vector<AfterDirection> after_by_direction(const model::Fit& fit, const model::Observations& before,
                                                             const model::Observations& after);

/// A part of what was left when measured again that has a shape: a constant, a slope, a difference of the directions.
struct RestPart {
  std::string shape;  ///< "constant", "slope", "reversal"
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  double size = 0.0;    ///< um, um/m; of a slope by metre, of an axis that turns by degree
  double rms_um = 0.0;  ///< of it, over all readings
  std::string text;     ///< "a constant -0.5 um of Z positions: zero or datum"
};
/// Largest first; those that stand out of the scatter of their line and are a twentieth of the squares at least.
[[nodiscard]] std::vector<RestPart> parts_of_rest(const model::Observations& after);

}  // namespace ecs::commissioning
