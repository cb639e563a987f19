// Readings of rotary axes as error motions over the angle, and their file (rotary_errors.hpp).
// Does not live here: readings of linear axes, whose map a unit holds (laser/map/).
#pragma once

#include <string>

#include "laser/measurement_set.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::volume {

/// Mean of the readings at each target, by approach where it is known.
/// Refused: readings of a linear axis, a component measured at two parked positions.
[[nodiscard]] Result<RotaryErrors> measured_rotary_errors(const laser::MeasurementSet& set);

/// The text of a file for read_rotary_errors(). @param machine  of its header; empty: none
[[nodiscard]] std::string rotary_csv(const RotaryErrors& errors, const std::string& machine);

}  // namespace ecs::volume
