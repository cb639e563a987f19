// The file of a circular test (ISO 230-4). Does not live here: what is computed of it (circle.hpp).
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "laser/circle_test.hpp"

namespace ecs::laser {

/// A pass with a wider gap is no circle; figure 7.22 of the thesis has a reading every 10 degrees.
inline constexpr double kWidestGap_deg = 15.0;

/// Reads `angle_deg,deviation_um,direction` (cw or ccw) and, where there are several, `run`, below `# plane: XY` (two
/// axes, the first at 0 and the second at 90 degrees) and `# radius_mm: 150`; `feed_mm_min`, `start_angle_deg` and
/// `centre_x_mm` … are optional. Counter-clockwise is the sense of rising angle. Refuses, with line and column: no
/// plane, no radius, a direction that is missing, an open circle (no reading over more than 15 degrees, the pass is
/// named), deviations of a millimetre and more.
[[nodiscard]] Result<CircleTest> parse_circle_test(std::string_view text, const std::string& file_name);

}  // namespace ecs::laser
