#include "ecs_emulator/machine/arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecs::emulator {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kSamePoint_mm = 1e-6;

}  // namespace

double Arc::length_mm() const { return 0.5 * (start_radius_mm + end_radius_mm) * std::abs(sweep_rad); }

void Arc::place(double part, Vector3& point_mm) const {
  const auto axes = axes_of(way.plane);
  const double angle_rad = start_rad + sweep_rad * part;
  const double radius_mm = start_radius_mm + (end_radius_mm - start_radius_mm) * part;
  point_mm[index_of(axes[0])] = way.centre_mm[0] + radius_mm * std::cos(angle_rad);
  point_mm[index_of(axes[1])] = way.centre_mm[1] + radius_mm * std::sin(angle_rad);
}

Vector3 Arc::direction(double part) const {
  const auto axes = axes_of(way.plane);
  const double angle_rad = start_rad + sweep_rad * part;
  const double onward = sweep_rad > 0.0 ? 1.0 : -1.0;
  Vector3 unit{};
  unit[index_of(axes[0])] = -onward * std::sin(angle_rad);
  unit[index_of(axes[1])] = onward * std::cos(angle_rad);
  return unit;
}

std::array<double, 2> Arc::range_mm(std::size_t of_plane) const {
  const std::size_t axis = index_of(axes_of(way.plane)[of_plane]);
  Vector3 start{}, end{};
  place(0.0, start);
  place(1.0, end);
  std::array<double, 2> range{std::min(start[axis], end[axis]), std::max(start[axis], end[axis])};
  const double radius_mm = std::max(start_radius_mm, end_radius_mm);
  const double low_rad = std::min(start_rad, start_rad + sweep_rad);
  const double high_rad = std::max(start_rad, start_rad + sweep_rad);
  const auto passes = [&](double angle_rad) {
    return angle_rad + kTurn_rad * std::ceil((low_rad - angle_rad) / kTurn_rad) <= high_rad;
  };
  const double top_rad = of_plane == 0 ? 0.0 : 0.5 * std::numbers::pi;
  if (passes(top_rad)) range[1] = std::max(range[1], way.centre_mm[of_plane] + radius_mm);
  if (passes(top_rad + std::numbers::pi)) range[0] = std::min(range[0], way.centre_mm[of_plane] - radius_mm);
  return range;
}

Arc arc_between(const Vector3& from_mm, const Vector3& to_mm, const ArcWay& way) {
  const auto axes = axes_of(way.plane);
  const std::size_t u = index_of(axes[0]);
  const std::size_t v = index_of(axes[1]);
  const std::array<double, 2> start{from_mm[u] - way.centre_mm[0], from_mm[v] - way.centre_mm[1]};
  const std::array<double, 2> end{to_mm[u] - way.centre_mm[0], to_mm[v] - way.centre_mm[1]};
  Arc arc{way, std::hypot(start[0], start[1]), std::hypot(end[0], end[1]), std::atan2(start[1], start[0]), 0.0};
  const double onward = way.clockwise ? -1.0 : 1.0;
  double sweep_rad = onward * (std::atan2(end[1], end[0]) - arc.start_rad);
  if (sweep_rad < 0.0) sweep_rad += kTurn_rad;
  if (std::hypot(to_mm[u] - from_mm[u], to_mm[v] - from_mm[v]) < kSamePoint_mm) sweep_rad = kTurn_rad;
  arc.sweep_rad = onward * sweep_rad;
  return arc;
}

}  // namespace ecs::emulator
