// The kinematic chain of a machine with linear axes X, Y, Z and up to two rotary axes A, B, C, the rigid-body error
// model of any chain as one table of terms, rotary axes among them, and what an error component does at the tool while
// the rotary axes stand at given angles: the terms with their levers worked out, affine in the positions of the linear
// axes. For a chain of linear axes these are the rows of core/terms.hpp (tests/kinematics/machine_pose_test.cpp holds
// them to each other). With the joints from the workpiece to the tool, N_j their motions (rotations about the fixed
// direction through the pivot), o the tool point where all joints are at 0:
//   tool point      P = N_1 N_2 … N_n o
//   error           E = Σ_b R_b [ δ_b + ε_b × L_b ]         orientation   Ω = Σ_b R_b ε_b       (frame of the
//   workpiece) lever           L_b = N_{first beyond b} … N_n o − r_b
// A linear carriage turns with its moving part, a rotary axis moves in the frame of its part that does not turn; so
// what lies beyond b counted towards the tool includes b itself for a linear axis that carries the workpiece and for a
// rotary axis that carries the tool. R_b turns from there to the workpiece; r_b is the measurement line, or the pivot.
// Sources: R. Schultschik, CIRP Annals 25 (1977) 223; S. Ibaraki, W. Knapp, Int. J. Automation Technol. 6 (2012) 110;
// names of ISO 230-1 and ISO 230-7.
// Does not live here: the three-axis chain that a unit compensates (core/terms.hpp), values of components, sums over a
// volume (volume/).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/axis.hpp"
#include "core/terms.hpp"

namespace ecs::kinematics {

/// An axis that moves: linear along, or rotary about, X, Y, Z. The first three have the numbers of core's Axis.
enum class Joint : std::uint8_t { X, Y, Z, A, B, C };

inline constexpr std::size_t kJoints = 6;
inline constexpr std::size_t kMostRotary = 2;
inline constexpr std::size_t kMostLetters = kAxes + kMostRotary;

template <class T>
using PerJoint = std::array<T, kJoints>;

[[nodiscard]] constexpr std::size_t index_of(Joint joint) { return static_cast<std::size_t>(joint); }
[[nodiscard]] constexpr bool is_rotary(Joint joint) { return joint >= Joint::A; }
[[nodiscard]] constexpr Joint joint_of(Axis axis) { return static_cast<Joint>(ecs::index_of(axis)); }
/// The direction along which, or about which, it moves where nothing else is said.
[[nodiscard]] constexpr Axis direction_of(Joint joint) { return static_cast<Axis>(index_of(joint) % kAxes); }
[[nodiscard]] constexpr char letter_of(Joint joint) { return "XYZABC"[index_of(joint)]; }
[[nodiscard]] constexpr std::optional<Joint> joint_of(char letter) {
  for (std::size_t j = 0; j < kJoints; ++j)
    if ("XYZABC"[j] == letter) return static_cast<Joint>(j);
  return std::nullopt;
}

struct ChainJoint {
  Joint joint = Joint::X;
  bool carries_workpiece = false;  ///< a letter before the T
  friend constexpr bool operator==(const ChainJoint&, const ChainJoint&) = default;
};

/// Every axis from the workpiece to the tool: that of "XYACTZ" is C A Y X | Z (ISO 10791-6: w C' A' Y' X' b Z t).
struct JointChain {
  std::array<ChainJoint, kMostLetters> joints{};
  std::size_t count = 0;

  [[nodiscard]] constexpr const ChainJoint* begin() const { return joints.data(); }
  [[nodiscard]] constexpr const ChainJoint* end() const { return joints.data() + count; }
  [[nodiscard]] constexpr bool has(Joint joint) const {
    for (const ChainJoint& one : *this)
      if (one.joint == joint) return true;
    return false;
  }
  friend constexpr bool operator==(const JointChain&, const JointChain&) = default;
};

/// What is wrong with a configuration, as what was expected; nothing: it is a chain. Letters as in core/terms.hpp, with
/// A, B, C among them: exactly one T, at least one of X, Y, Z, none twice, at most two rotary axes.
[[nodiscard]] std::optional<std::string> fault_of(std::string_view configuration);

/// Nothing if fault_of() finds one.
[[nodiscard]] std::optional<JointChain> joint_chain_of(std::string_view configuration);

/// The letters without those of rotary axes: the chain that a unit compensates.
[[nodiscard]] std::string linear_configuration(std::string_view configuration);

/// As ISO 10791-6 writes it, from the workpiece over the bed to the tool: "w C' A' Y' X' b Z t".
[[nodiscard]] std::string iso_notation(const JointChain& chain);

/// One row: the error of `moving` in `sense` adds to the tool point along `observed`, in the frame of `moving`.
struct JointTerm {
  Axis observed = Axis::X;
  Joint moving = Joint::X;
  Sense sense = Sense::EX;
  bool has_lever = false;
  Axis lever = Axis::X;  ///< direction of the lever arm, if has_lever
  std::int8_t sign = 1;
  friend constexpr bool operator==(const JointTerm&, const JointTerm&) = default;
};

/// A constant between two linear axes: the motion of `lever` leans, so that it adds along `observed`, in its own frame.
struct SquarenessTerm {
  Axis observed = Axis::X;
  Component component = Component::C0Y;
  Axis lever = Axis::Y;
  std::int8_t sign = 1;
};

struct JointTable {
  std::array<JointTerm, kMostLetters * 9> rows{};  ///< 3 translations, 3 rotations of two directions each
  std::size_t count = 0;
  std::array<SquarenessTerm, 3> squareness{};
  std::size_t squareness_count = 0;
};

/// The terms of a chain, in the order of the joints X Y Z A B C, then senses, then observed directions.
[[nodiscard]] JointTable terms_of(const JointChain& chain);

/// True where the position of `other` is part of the lever arm of `b`: the rule above.
[[nodiscard]] bool is_beyond(const JointChain& chain, Joint b, Joint other, CurveKind curves);

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
