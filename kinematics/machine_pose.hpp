// What an error component does at the tool while the rotary axes of a machine stand at given angles: the terms of
// joint_terms.hpp with their levers worked out. Affine in the positions of the linear axes.
// Does not live here: values of components, sums over a volume (volume/).
#pragma once

#include "kinematics/joint_terms.hpp"

namespace ecs::kinematics {

/// Where a rotary axis turns, all axes at 0, in machine coordinates: a tool-side pivot is counted from the point whose
/// position the coordinates give, a workpiece-side one is where that point stands above it.
struct RotaryGeometry {
  Vector3 direction{0.0, 0.0, 1.0};  ///< of positive rotation of the tool against the workpiece, length 1
  Vector3 pivot_mm{};                ///< a point on the axis; its EX., EY., EZ. are those of this point
};

/// A machine with what its geometry needs. Rotary axes are numbered A, B, C.
struct JointMachine {
  JointChain chain{};
  JointTable terms{};  ///< terms_of(chain)
  std::array<RotaryGeometry, kAxes> rotary{};
  MeasurementLines lines_mm{};  ///< of the linear axes, measured with the rotary axes at 0
  Vector3 tool_offset_mm{};     ///< from the point at which the curves were measured to the tool point, angles at 0
  CurveKind curves = CurveKind::carriage;
};

using Angles = std::array<double, kAxes>;  ///< of A, B, C [deg]; tool against workpiece, right-handed

/// A vector that grows with the positions of the linear axes: at_0 + Σ_l slope[l]·p_l [mm].
struct AffineVector {
  Vector3 at_0{};
  std::array<Vector3, kAxes> slope{};
  [[nodiscard]] Vector3 at(const Vector3& position_mm) const;
};

/// What 1 um or 1 um/m of one component does at the tool [um], in the frame of the workpiece.
struct Gain {
  Vector3 at_0{};
  std::array<Vector3, kAxes> slope{};  ///< by linear axis [um/mm]
};

/// One setting of the rotary axes.
struct MachinePose {
  AffineVector tool_mm;                          ///< nominal tool point in the frame of the workpiece
  PerJoint<std::array<Gain, 6>> gain{};          ///< by joint and sense
  PerJoint<std::array<Vector3, kAxes>> about{};  ///< by joint and EA, EB, EC: direction of the rotation at the tool
  std::array<Gain, kComponents - kCurves> squareness{};
  std::array<Vector3, kAxes> along{};  ///< by linear axis: its direction in the frame of the workpiece
  std::array<Vector3, kAxes> bed{};    ///< X, Y, Z of the machine that does not move, in the frame of the workpiece
  std::array<Vector3, kAxes> tool{};   ///< X, Y, Z of the tool at angles of 0, in the frame of the workpiece
};

[[nodiscard]] MachinePose pose_at(const JointMachine& machine, const Angles& angles_deg);

/// Values of every component at one place; location errors of a rotary axis (XOC, AOC, …) are added to its curves.
struct JointValues {
  PerJoint<std::array<double, 6>> curve{};  ///< by joint and sense [um, um/m]
  ComponentValues squareness{};             ///< of C0Y, B0Z, A0Z [um/m]
};

/// Tool against workpiece, in the frame of the workpiece, to first order.
struct ToolError {
  Vector3 error_um{};
  Vector3 orientation_um_per_m{};
};
[[nodiscard]] ToolError tool_error(const MachinePose& pose, const JointValues& values, const Vector3& position_mm);

/// v turned about `direction` (length 1) by an angle, right-handed.
[[nodiscard]] Vector3 turned(const Vector3& v, const Vector3& direction, double angle_deg);

}  // namespace ecs::kinematics
