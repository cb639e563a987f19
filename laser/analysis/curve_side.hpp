// One side of a curve (forward, reverse or mean) as a piecewise linear function.
// Does not live here: what is done with it (process.hpp).
#pragma once

#include <optional>
#include <vector>

#include "laser/analysis/curve.hpp"

namespace ecs::laser {

/// A value at a position, with what is known about its scatter.
struct SidePoint {
  double position_mm = 0.0;
  double value = 0.0;
  int count = 0;
  std::optional<double> std;
};

enum class Side { forward, reverse };

/// The points that have that side, ascending.
[[nodiscard]] std::vector<SidePoint> side_of(const Curve& curve, Side side);

/// Puts a value on that side of a point; nothing leaves the side empty.
void set_side(CurvePoint& point, Side side, const std::optional<SidePoint>& value);

/// Linear between neighbours; a position within `tolerance_mm` of a point takes that point. Beyond the ends: the end
/// point where `hold`, else nothing. Nothing for no points.
[[nodiscard]] std::optional<SidePoint> point_at(const std::vector<SidePoint>& side, double position_mm,
                                                double tolerance_mm, bool hold);

}  // namespace ecs::laser
