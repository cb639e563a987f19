// A circular test as CSV. Does not live here: its reader (laser/standards/circle_file.hpp).
#pragma once

#include <string>

#include "laser/circle_test.hpp"

namespace ecs::laser {

/// Plane, radius, feed, start and centre as `# key: value` from their members, other metadata before them, then
/// angle_deg,deviation_um,direction,run.
[[nodiscard]] std::string to_csv(const CircleTest& test);

}  // namespace ecs::laser
