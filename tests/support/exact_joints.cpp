#include "tests/support/exact_joints.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

namespace ecs::test {
namespace {

using Pose = Eigen::Isometry3d;
using Vector = Eigen::Vector3d;

Vector eigen(const Vector3& v) { return {v[0], v[1], v[2]}; }
Vector3 plain(const Vector& v) { return {v.x(), v.y(), v.z()}; }

Pose shift(const Vector& by) { return Pose(Eigen::Translation3d(by)); }
Pose turn(const Vector& angle_rad) {
  Pose pose = Pose::Identity();
  if (angle_rad.norm() > 0.0)
    pose.linear() = Eigen::AngleAxisd(angle_rad.norm(), angle_rad.normalized()).toRotationMatrix();
  return pose;
}
Pose turn_about(const Vector& point, const Vector& angle_rad) { return shift(point) * turn(angle_rad) * shift(-point); }

struct SixErrors {
  Vector moved_mm, turned_rad;
};
SixErrors six(const std::array<double, 6>& values) {
  return {Vector(values[0], values[1], values[2]) * 1e-3, Vector(values[3], values[4], values[5]) * 1e-6};
}

/// X is straight; Y leans towards −X by C0Y; Z towards +X by B0Z and towards −Y by A0Z.
Vector leaning(const ComponentValues& squareness, char axis) {
  const auto of = [&](Component c) { return squareness[index_of(c)] * 1e-6; };
  if (axis == 'X') return Vector::UnitX();
  if (axis == 'Y') return turn({0.0, 0.0, of(Component::C0Y)}) * Vector::UnitY();
  return turn({of(Component::A0Z), of(Component::B0Z), 0.0}) * Vector::UnitZ();
}

/// The body that a joint moves, on the body that carries it. `side`: 1 tool, −1 workpiece, which runs the other way.
Pose body(const ExactMachine& m, char letter, double side, const Vector3& position_mm,
          const kinematics::Angles& angles_deg, const std::string& levers) {
  const std::size_t j = std::string("XYZABC").find(letter);
  const SixErrors error = six(m.values.curve[j]);
  if (j < kAxes) {
    Vector centre = Vector::Zero();
    for (const char lever : levers)
      if (const std::size_t l = std::string("XYZ").find(lever); l != std::string::npos)
        centre[static_cast<Eigen::Index>(l)] = m.lines_mm[j][l];
    const Vector moved = position_mm[j] * leaning(m.values.squareness, letter) + error.moved_mm;
    return shift(side * moved) * turn_about(centre, side * error.turned_rad);
  }
  const kinematics::RotaryGeometry& axis = m.rotary[j - kAxes];
  const Vector pivot = eigen(axis.pivot_mm);
  const SixErrors place = six(m.location[j - kAxes]);
  const double angle = angles_deg[j - kAxes] * std::numbers::pi / 180.0;
  return shift(side * place.moved_mm) * turn_about(pivot, side * place.turned_rad) * shift(side * error.moved_mm) *
         turn_about(pivot, side * error.turned_rad) * turn_about(pivot, side * angle * eigen(axis.direction));
}

}  // namespace

Eigen::Isometry3d exact_pose(const ExactMachine& m, const Vector3& position_mm, const kinematics::Angles& angles_deg) {
  const std::size_t tool = m.configuration.find('T');
  const std::string workpiece_side = m.configuration.substr(0, tool), tool_side = m.configuration.substr(tool + 1);
  Pose table = Pose::Identity(), spindle = Pose::Identity();
  for (std::size_t i = 0; i < workpiece_side.size(); ++i)
    table =
        table * body(m, workpiece_side[i], -1.0, position_mm, angles_deg, tool_side + workpiece_side.substr(0, i + 1));
  for (std::size_t i = 0; i < tool_side.size(); ++i)
    spindle = spindle * body(m, tool_side[i], 1.0, position_mm, angles_deg, tool_side.substr(i + 1));
  return table.inverse() * spindle * shift(eigen(m.tool_offset_mm));
}

kinematics::ToolError exact_tool_error(const ExactMachine& machine, const Vector3& position_mm,
                                       const kinematics::Angles& angles_deg) {
  ExactMachine ideal = machine;
  ideal.values = {};
  ideal.location = {};
  const Pose is = exact_pose(machine, position_mm, angles_deg), should = exact_pose(ideal, position_mm, angles_deg);
  const Eigen::AngleAxisd turned(is.linear() * should.linear().transpose());
  return {plain((is.translation() - should.translation()) * 1e3), plain(turned.axis() * turned.angle() * 1e6)};
}

std::vector<std::string> chains_of(std::string letters) {
  std::vector<std::string> chains;
  letters += 'T';
  std::sort(letters.begin(), letters.end());
  do chains.push_back(letters);
  while (std::next_permutation(letters.begin(), letters.end()));
  return chains;
}

std::vector<std::string> every_rotary_chain() {
  std::vector<std::string> chains;
  for (const char* linear : {"X", "Y", "Z", "XY", "XZ", "YZ", "XYZ"})
    for (const char* rotary : {"A", "B", "C", "AB", "AC", "BC"})
      for (const std::string& chain : chains_of(std::string(linear) + rotary)) chains.push_back(chain);
  return chains;
}

}  // namespace ecs::test
