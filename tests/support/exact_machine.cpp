#include "tests/support/exact_machine.hpp"

namespace ecs::test {
namespace {

using Pose = Eigen::Isometry3d;
using Vector = Eigen::Vector3d;

Vector as_vector(const Vector3& v) { return {v[0], v[1], v[2]}; }

double value(const MachineErrors& errors, const char* name) { return errors.values[index_of(*component_of(name))]; }

/// Right-handed rotation by the length of `angle` [rad] about its direction.
Pose rotation(const Vector& angle) {
  Pose pose = Pose::Identity();
  if (angle.norm() > 0.0) pose.linear() = Eigen::AngleAxisd(angle.norm(), angle.normalized()).toRotationMatrix();
  return pose;
}
Pose translation(const Vector& by) { return Pose(Eigen::Translation3d(by)); }
Pose rotation_about(const Vector& point, const Vector& angle) {
  return translation(point) * rotation(angle) * translation(-point);
}

/// X is the reference; Y leans towards −X by C0Y; Z leans towards +X by B0Z and towards −Y by A0Z.
Vector direction(const MachineErrors& errors, char axis) {
  if (axis == 'X') return Vector::UnitX();
  if (axis == 'Y') return rotation({0.0, 0.0, value(errors, "C0Y") * 1e-6}) * Vector::UnitY();
  return rotation({value(errors, "A0Z") * 1e-6, value(errors, "B0Z") * 1e-6, 0.0}) * Vector::UnitZ();
}

struct Carriage {
  Vector moved_mm;   ///< along its true direction, translations included
  Vector angle_rad;  ///< roll, pitch, yaw
  Vector centre_mm;  ///< the point on the measurement line, in the directions of its levers
};

Carriage carriage(const MachineErrors& errors, char axis, const Vector3& position_mm, const std::string& levers) {
  const std::string name(1, axis);
  const auto of = [&](const char* sense) { return value(errors, (sense + name).c_str()); };
  const auto place = static_cast<std::size_t>(axis - 'X');
  Carriage c{.moved_mm = position_mm[place] * direction(errors, axis) + Vector(of("EX"), of("EY"), of("EZ")) * 1e-3,
             .angle_rad = Vector(of("EA"), of("EB"), of("EC")) * 1e-6,
             .centre_mm = Vector::Zero()};
  for (const char lever : levers) {
    const auto l = static_cast<std::size_t>(lever - 'X');
    c.centre_mm[static_cast<Eigen::Index>(l)] = errors.lines_mm[place][l];
  }
  return c;
}

}  // namespace

Vector3 exact_error_um(const std::string& configuration, const MachineErrors& errors, const Vector3& position_mm) {
  const std::size_t tool = configuration.find('T');
  const std::string workpiece_side = configuration.substr(0, tool);
  const std::string tool_side = configuration.substr(tool + 1);

  Pose table = Pose::Identity();
  for (std::size_t i = 0; i < workpiece_side.size(); ++i) {
    const Carriage c = carriage(errors, workpiece_side[i], position_mm, tool_side + workpiece_side.substr(0, i + 1));
    table = table * translation(-c.moved_mm) * rotation_about(c.centre_mm, -c.angle_rad);
  }
  Pose spindle = Pose::Identity();
  for (std::size_t i = 0; i < tool_side.size(); ++i) {
    const Carriage c = carriage(errors, tool_side[i], position_mm, tool_side.substr(i + 1));
    spindle = spindle * translation(c.moved_mm) * rotation_about(c.centre_mm, c.angle_rad);
  }
  Vector commanded = as_vector(errors.tool_offset_mm);
  for (const char axis : workpiece_side + tool_side) {
    const auto a = static_cast<std::size_t>(axis - 'X');
    commanded[static_cast<Eigen::Index>(a)] += position_mm[a];
  }
  const Vector error_mm = table.inverse() * (spindle * as_vector(errors.tool_offset_mm)) - commanded;
  return {error_mm.x() * 1e3, error_mm.y() * 1e3, error_mm.z() * 1e3};
}

}  // namespace ecs::test
