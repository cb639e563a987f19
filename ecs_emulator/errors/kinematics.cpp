#include "ecs_emulator/errors/kinematics.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

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

using Eigen::Isometry3d;

Isometry3d shifted(const Vector3d& by) { return Isometry3d(Eigen::Translation3d(by)); }

Isometry3d turned_about(const Vector3d& centre, const Matrix3d& rotation) {
  return shifted(centre) * Isometry3d(rotation) * shifted(-centre);
}

/// An error vector in um and um/m as a motion about a point.
Isometry3d moved_by(const SixOfAxis& error, const Vector3d& centre) {
  return shifted(Vector3d(error[0], error[1], error[2]) * kMmPerUm) *
         turned_about(centre, rotation_by(Vector3d(error[3], error[4], error[5]) * kRadPerUmPerM));
}

/// What one body of the chain does to a point of the next.
Isometry3d motion_of(const TurningGeometry& geometry, char letter, bool workpiece, const ComponentValues& errors,
                     const RotaryValues& rotary, const Vector3& position_mm, const Vector3& angle_deg) {
  if (const auto axis = axis_of(letter)) {
    const Carriage c = carriage_of(*axis, geometry.linear, errors, position_mm[index_of(*axis)]);
    const Isometry3d error = shifted(c.delta_mm) * turned_about(c.centre_mm, c.rotation);
    return workpiece ? error * shifted(c.travel_mm) : shifted(c.travel_mm) * error;
  }
  const auto r = static_cast<std::size_t>(letter - 'A');
  const Vector3d pivot = eigen(geometry.rotary[r]->pivot_mm);
  const Isometry3d error = moved_by(rotary.location[r], pivot) * moved_by(rotary.motion[r], pivot);
  const Isometry3d turn =
      turned_about(pivot, rotation_by(eigen(geometry.rotary[r]->direction) * (angle_deg[r] * EIGEN_PI / 180.0)));
  return workpiece ? turn * error : error * turn;
}

/// From a point of the tool to the workpiece.
Isometry3d through_machine(const TurningGeometry& geometry, const ComponentValues& errors, const RotaryValues& rotary,
                           const Vector3& position_mm, const Vector3& angle_deg) {
  const std::string& letters = geometry.configuration;
  const std::size_t t = letters.find('T');
  Isometry3d tool = moved_by(rotary.of_machine, Vector3d::Zero()), table = Isometry3d::Identity();
  for (std::size_t i = t + 1; i < letters.size(); ++i)
    tool = tool * motion_of(geometry, letters[i], false, errors, rotary, position_mm, angle_deg);
  for (std::size_t i = 0; i < t; ++i)
    table = motion_of(geometry, letters[i], true, errors, rotary, position_mm, angle_deg) * table;
  return table * tool;
}

std::array<Vector3, kAxes> columns_of(const Matrix3d& m) {
  std::array<Vector3, kAxes> columns{};
  for (std::size_t c = 0; c < kAxes; ++c)
    for (std::size_t r = 0; r < kAxes; ++r)
      columns[c][r] = m(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
  return columns;
}

}  // namespace

TurningGeometry turning_geometry_of(const params::Machine& machine, const Vector3& tool_offset_mm) {
  TurningGeometry geometry;
  if (const auto chain = params::chain_of(machine)) geometry.linear.chain = *chain;
  geometry.linear.lines_mm = params::measurement_lines_of(machine);
  geometry.linear.tool_offset_mm = tool_offset_mm;
  geometry.configuration = machine.rotary_configuration;
  geometry.rotary = machine.rotary;
  return geometry;
}

TurningPose turning_pose(const TurningGeometry& geometry, const ComponentValues& errors, const RotaryValues& rotary,
                         const Vector3& position_mm, const Vector3& angle_deg) {
  const Vector3d offset = eigen(geometry.linear.tool_offset_mm);
  const Isometry3d should = through_machine(geometry, {}, {}, position_mm, angle_deg);
  const Vector3d nominal = should * offset;
  RotaryValues with_tool = rotary;
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < 2 * kAxes; ++s)
      with_tool.motion[r][s] += rotary.of_tool[r][s] * offset.norm() / kMmPerM;
  const Vector3d error_um =
      (through_machine(geometry, errors, with_tool, position_mm, angle_deg) * offset - nominal) / kMmPerUm;
  TurningGeometry bed = geometry;
  bed.configuration = geometry.configuration.substr(0, geometry.configuration.find('T') + 1);
  return {{nominal[0], nominal[1], nominal[2]},
          {error_um[0], error_um[1], error_um[2]},
          columns_of(through_machine(bed, {}, {}, position_mm, angle_deg).linear()),
          columns_of(should.linear())};
}

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

namespace {

/// A rotary axis as one of its effects sees it.
double value_of_motion(const RotaryMotion& one, Variables& variables, const RotaryState& state) {
  const double angle_deg = state.angle_deg[one.axis];
  const Approach side = state.approach[one.axis];
  const double way = side == Approach::reverse ? -1.0 : 1.0;
  if (one.curve) {
    variables.p = angle_deg;
    variables.d = way;
    return one.curve->value(variables);
  }
  const PlacedEffect& effect = *one.effect;
  if (effect.approach != Approach::unknown && effect.approach != side) return 0.0;
  return effect.kind->value(effect, {.p_mm = angle_deg, .approach = way, .time_s = state.time_s});
}

}  // namespace

RotaryValues values_of(const RotaryParts& parts, Variables& variables, const RotaryState& state) {
  RotaryValues values;
  values.location = parts.location;
  variables.t = state.time_s;
  for (const RotaryMotion& one : parts.motions) {
    SixOfAxis& motion = one.bends == Bends::machine ? values.of_machine
                        : one.bends == Bends::tool  ? values.of_tool[one.axis]
                                                    : values.motion[one.axis];
    motion[static_cast<std::size_t>(one.sense)] += value_of_motion(one, variables, state);
  }
  return values;
}

std::string rotary_name(std::size_t axis, Sense sense) { return fmt::format("{}{}", name_of(sense), "ABC"[axis]); }

std::string location_name(std::size_t axis, std::size_t letter) {
  return fmt::format("{}O{}", "XYZABC"[letter], "ABC"[axis]);
}

}  // namespace ecs::emulator
