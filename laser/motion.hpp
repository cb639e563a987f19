// The passes of an axis from nothing but the order of its stops. Does not live here: where the stops come from.
#pragma once

#include <cstddef>
#include <vector>

#include "core/axis.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

struct MotionStop {
  Approach approach = Approach::unknown;
  int run = 1;  ///< how often the axis has gone this way, from 1
};

/// One for each position. A pass ends where the direction turns; a stop repeated at the turn begins the next pass. A
/// single jump back followed by the old direction begins another pass the same way. One lone position: unknown.
[[nodiscard]] std::vector<MotionStop> motion_of(const std::vector<double>& positions_mm);

/// Gives readings of a file that states no approach the direction in which their axis came, in each run that goes both
/// ways: unlike in `motion_of`, nobody said that the order is that of the motion, so what it leaves open stays unknown:
/// the first stop of a run, a single step back between two forward ones, positions in no order, a run that goes one
/// way. Where an axis turns, twice the usual number of readings are half of each pass. Paths (circles, diagonals) state
/// their own direction.
/// @return how many readings got one
std::size_t take_approach_from_order(MeasurementSet& set);

}  // namespace ecs::laser
