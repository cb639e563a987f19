// The passes of an axis from nothing but the order of its stops. Does not live here: where the stops come from.
#pragma once

#include <vector>

#include "core/axis.hpp"

namespace ecs::laser {

struct MotionStop {
  Approach approach = Approach::unknown;
  int run = 1;  ///< how often the axis has gone this way, from 1
};

/// One for each position. A pass ends where the direction turns; a stop repeated at the turn begins the next pass. A
/// single jump back followed by the old direction begins another pass the same way. One lone position: unknown.
[[nodiscard]] std::vector<MotionStop> motion_of(const std::vector<double>& positions_mm);

}  // namespace ecs::laser
