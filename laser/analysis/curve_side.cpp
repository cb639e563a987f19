#include "laser/analysis/curve_side.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::laser {

std::vector<SidePoint> side_of(const Curve& curve, Side side) {
  std::vector<SidePoint> points;
  for (const CurvePoint& p : curve.points) {
    if (side == Side::forward && p.forward)
      points.push_back({p.position_mm, *p.forward, p.forward_count, p.forward_std});
    if (side == Side::reverse && p.reverse)
      points.push_back({p.position_mm, *p.reverse, p.reverse_count, p.reverse_std});
  }
  return points;
}

void set_side(CurvePoint& point, Side side, const std::optional<SidePoint>& value) {
  const bool forward = side == Side::forward;
  (forward ? point.forward : point.reverse) = value ? std::optional(value->value) : std::nullopt;
  (forward ? point.forward_count : point.reverse_count) = value ? value->count : 0;
  (forward ? point.forward_std : point.reverse_std) = value ? value->std : std::nullopt;
}

std::optional<SidePoint> point_at(const std::vector<SidePoint>& side, double position_mm, double tolerance_mm,
                                  bool hold) {
  if (side.empty()) return std::nullopt;
  const auto above = std::lower_bound(side.begin(), side.end(), position_mm,
                                      [](const SidePoint& point, double p) { return point.position_mm < p; });
  for (const auto near : {above, above == side.begin() ? above : std::prev(above)}) {
    if (near == side.end() || std::abs(near->position_mm - position_mm) > tolerance_mm) continue;
    SidePoint found = *near;
    found.position_mm = position_mm;
    return found;
  }
  if (above == side.begin() || above == side.end()) {
    if (!hold) return std::nullopt;
    SidePoint end = above == side.end() ? side.back() : side.front();
    end.position_mm = position_mm;
    return end;
  }
  const SidePoint& high = *above;
  const SidePoint& low = *std::prev(above);
  const double share = (position_mm - low.position_mm) / (high.position_mm - low.position_mm);
  SidePoint between{position_mm, std::lerp(low.value, high.value, share), std::min(low.count, high.count),
                    std::nullopt};
  if (low.std && high.std) between.std = std::lerp(*low.std, *high.std, share);
  return between;
}

}  // namespace ecs::laser
