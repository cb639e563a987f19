// Circular arcs in a plane of two axes: where they run. Does not live here: how fast (path.hpp).
#pragma once

#include <array>

#include "core/axis.hpp"

namespace ecs::emulator {

/// Plane of an arc. Its first and second axis: X Y, Z X, Y Z; counter-clockwise turns the first towards the second
/// (ISO 6983: seen from the positive end of the third axis).
enum class Plane : std::uint8_t { XY, ZX, YZ };

[[nodiscard]] constexpr std::array<Axis, 3> axes_of(Plane plane) {
  if (plane == Plane::ZX) return {Axis::Z, Axis::X, Axis::Y};
  if (plane == Plane::YZ) return {Axis::Y, Axis::Z, Axis::X};
  return {Axis::X, Axis::Y, Axis::Z};
}

/// How to go round, from one point of the plane to another.
struct ArcWay {
  Plane plane = Plane::XY;
  std::array<double, 2> centre_mm{};  ///< along the first and the second axis of the plane
  bool clockwise = false;
};

/// An arc of which everything is known. Where the two radii differ, it winds evenly from the one to the other.
struct Arc {
  ArcWay way{};
  double start_radius_mm = 0.0;
  double end_radius_mm = 0.0;
  double start_rad = 0.0;  ///< from the first axis of the plane towards the second
  double sweep_rad = 0.0;  ///< positive: counter-clockwise; never 0

  [[nodiscard]] double length_mm() const;
  /// Puts the point at `part` of the sweep (0 to 1) into the two coordinates of the plane.
  void place(double part, Vector3& point_mm) const;
  /// Unit vector along the arc.
  [[nodiscard]] Vector3 direction(double part) const;
  /// Lowest and highest coordinate along one axis of the plane (0: its first, 1: its second).
  [[nodiscard]] std::array<double, 2> range_mm(std::size_t of_plane) const;
};

/// Ends less than a nanometre apart make a full circle.
/// @pre  neither end lies on the centre
[[nodiscard]] Arc arc_between(const Vector3& from_mm, const Vector3& to_mm, const ArcWay& way);

}  // namespace ecs::emulator
