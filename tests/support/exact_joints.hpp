// A machine tool with rotary axes as rigid bodies, with exact rotation matrices: the oracle of kinematics/.
// Written from the definition (docs/five_axes.md) and shares no code with kinematics/ but its plain types: bed to tool
// and bed to workpiece are multiplied out one after the other, each body with the error of its joint.
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "kinematics/machine_pose.hpp"

namespace ecs::test {

/// Geometry and errors of a machine at one pose.
struct ExactMachine {
  std::string configuration;
  std::array<kinematics::RotaryGeometry, kAxes> rotary{};
  MeasurementLines lines_mm{};
  Vector3 tool_offset_mm{};
  kinematics::JointValues values{};                     ///< um, um/m, location errors not among them
  std::array<std::array<double, 6>, kAxes> location{};  ///< of A, B, C: XO., YO., ZO., AO., BO., CO.
};

/// The pose of the tool in the frame of the workpiece, errors as they are.
[[nodiscard]] Eigen::Isometry3d exact_pose(const ExactMachine& machine, const Vector3& position_mm,
                                           const kinematics::Angles& angles_deg);

/// Against the same machine without errors: the tool point [um], the orientation as a rotation vector [um/m].
[[nodiscard]] kinematics::ToolError exact_tool_error(const ExactMachine& machine, const Vector3& position_mm,
                                                     const kinematics::Angles& angles_deg);

/// Every chain of these letters with T at any place.
[[nodiscard]] std::vector<std::string> chains_of(std::string letters);
/// Those of one to three linear axes and one or two rotary ones.
[[nodiscard]] std::vector<std::string> every_rotary_chain();

}  // namespace ecs::test
