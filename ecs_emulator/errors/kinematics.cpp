#include "ecs_emulator/errors/kinematics.hpp"

#include <Eigen/Geometry>

#include "base/units.hpp"

namespace ecs::emulator {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMmPerUm = 1e-3;

/// Errors of one axis as vectors.
struct Carriage {
  Vector3d travel_mm = Vector3d::Zero();
  Vector3d delta_mm = Vector3d::Zero();
  Vector3d centre_mm = Vector3d::Zero();
  Matrix3d rotation = Matrix3d::Identity();
};

Vector3d eigen(const Vector3& v) { return {v[0], v[1], v[2]}; }

Matrix3d rotation_by(const Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle == 0.0) return Matrix3d::Identity();
  return AngleAxisd(angle, vector_rad / angle).toRotationMatrix();
}

/// The direction of travel, tilted: E_X = −C0Y·Y, E_X = +B0Z·Z, E_Y = −A0Z·Z. Squareness needs both axes.
Vector3d direction_of(Axis axis, const Chain& chain, const ComponentValues& errors) {
  const auto tilt = [&](Component c, Axis other) {
    return chain.has(other) ? errors[index_of(c)] * kRadPerUmPerM : 0.0;
  };
  if (axis == Axis::X) return Vector3d::UnitX();
  if (axis == Axis::Y) return AngleAxisd(tilt(Component::C0Y, Axis::X), Vector3d::UnitZ()) * Vector3d::UnitY();
  return AngleAxisd(tilt(Component::A0Z, Axis::Y), Vector3d::UnitX()) *
         (AngleAxisd(tilt(Component::B0Z, Axis::X), Vector3d::UnitY()) * Vector3d::UnitZ());
}

Carriage carriage_of(Axis axis, const ChainGeometry& geometry, const ComponentValues& errors, double position_mm) {
  const auto value = [&](Sense s) { return errors[index_of(curve_of(s, axis))]; };
  Carriage carriage;
  carriage.travel_mm = direction_of(axis, geometry.chain, errors) * position_mm;
  carriage.delta_mm = Vector3d(value(Sense::EX), value(Sense::EY), value(Sense::EZ)) * kMmPerUm;
  carriage.rotation = rotation_by(Vector3d(value(Sense::EA), value(Sense::EB), value(Sense::EC)) * kRadPerUmPerM);
  for (const Axis lever : kAllAxes) {
    const auto i = static_cast<Eigen::Index>(index_of(lever));
    if (is_lever(geometry.chain, axis, lever))
      carriage.centre_mm[i] = geometry.lines_mm[index_of(axis)][index_of(lever)];
  }
  return carriage;
}

/// The axes of one side from the base outward; -1 where there is none.
std::array<int, kAxes> order_of(const Chain& chain, bool workpiece) {
  std::array<int, kAxes> order{-1, -1, -1};
  for (const Axis a : kAllAxes)
    if (chain.has(a) && chain.carries_workpiece[index_of(a)] == workpiece)
      order[static_cast<std::size_t>(chain.order[index_of(a)])] = static_cast<int>(index_of(a));
  return order;
}

}  // namespace

ToolPose tool_pose(const ChainGeometry& geometry, const ComponentValues& errors, const Vector3& position_mm) {
  Vector3d point = eigen(geometry.tool_offset_mm);
  Vector3d nominal = point;
  Matrix3d rotation = Matrix3d::Identity();
  const auto carriage = [&](int axis) {
    const auto i = static_cast<std::size_t>(axis);
    nominal[axis] += position_mm[i];
    return carriage_of(static_cast<Axis>(i), geometry, errors, position_mm[i]);
  };
  const auto tool_side = order_of(geometry.chain, false);
  for (auto axis = tool_side.rbegin(); axis != tool_side.rend(); ++axis) {  // the outermost carries the tool
    if (*axis < 0) continue;
    const Carriage c = carriage(*axis);
    point = c.travel_mm + c.delta_mm + c.rotation * (point - c.centre_mm) + c.centre_mm;
    rotation = c.rotation * rotation;
  }
  for (const int axis : order_of(geometry.chain, true)) {
    if (axis < 0) continue;
    const Carriage c = carriage(axis);
    point = c.delta_mm + c.rotation * (point + c.travel_mm - c.centre_mm) + c.centre_mm;
    rotation = c.rotation * rotation;
  }
  const Vector3d error_um = (point - nominal) / kMmPerUm;
  const AngleAxisd turned(rotation);
  const Vector3d turned_um_per_m = turned.axis() * (turned.angle() / kRadPerUmPerM);
  return {{error_um[0], error_um[1], error_um[2]}, {turned_um_per_m[0], turned_um_per_m[1], turned_um_per_m[2]}};
}

}  // namespace ecs::emulator
