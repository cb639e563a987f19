// Where the tool really is: the chain of carriages as exact matrices, not linearised (thesis 4.3, equations 5-19); and
// the true errors of rotary axes A, B, C: error motions over their angle and the place of their axis lines (ISO 230-7),
// as the errors file gives them. Does not live here: how large the errors of linear axes are
// (true_errors.hpp), how they are measured (ecs_emulator/instruments/laser.hpp).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/axis.hpp"
#include "core/terms.hpp"
#include "ecs_emulator/effects/effects.hpp"
#include "ecs_emulator/errors/formula.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

/// All that they may depend on.
struct RotaryState {
  Vector3 angle_deg{};  ///< of A, B, C
  PerAxis<Approach> approach{Approach::forward, Approach::forward, Approach::forward};
  double time_s = 0.0;
};

using SixOfAxis = std::array<double, 6>;  ///< by sense: EX EY EZ [um], EA EB EC [um/m]

struct RotaryValues {
  PerAxis<SixOfAxis> motion{};    ///< of A, B, C at their angles
  PerAxis<SixOfAxis> location{};  ///< XO., YO., ZO., AO., BO., CO.
  PerAxis<SixOfAxis> of_tool{};   ///< as `motion`, for each metre of the tool's length
  SixOfAxis of_machine{};         ///< shift of what carries a head, along X, Y, Z of the bed
};

/// What an error motion follows besides the angle.
enum class Bends : std::uint8_t {
  nothing,
  machine,  ///< along X, Y, Z of the bed, whatever carries the axis
  tool      ///< in proportion to the length of the tool
};

/// One error motion: a curve over the angle, or an effect of the emulator's list with degrees in place of mm.
struct RotaryMotion {
  std::size_t axis = 0;  ///< A, B, C
  Sense sense = Sense::EX;
  std::optional<ErrorCurve> curve;
  std::optional<PlacedEffect> effect;
  int line = 0;  ///< of its table
  Bends bends = Bends::nothing;
};

struct RotaryParts {
  PerAxis<SixOfAxis> location{};
  std::vector<RotaryMotion> motions;
  PerAxis<int> line{};  ///< of a table that names the axis; 0: none does
};

[[nodiscard]] RotaryValues values_of(const RotaryParts& parts, Variables& variables, const RotaryState& state);

/// "EXC", "EAB"
[[nodiscard]] std::string rotary_name(std::size_t axis, Sense sense);
/// "XOC", "AOB"
[[nodiscard]] std::string location_name(std::size_t axis, std::size_t letter);

/// The machine's geometry apart from its errors.
struct ChainGeometry {
  Chain chain{};
  MeasurementLines
      lines_mm{};  ///< each axis's rotation acts about this point; coordinates that are no lever count as 0
  Vector3 tool_offset_mm{};
};

/// A machine with rotary axes: letters before the T carry the workpiece, after it the tool, from the bed outward.
struct TurningGeometry {
  ChainGeometry linear;
  std::string configuration;  ///< "XYACTZ"
  PerAxis<std::optional<params::MachineRotaryAxis>> rotary{};
};

[[nodiscard]] TurningGeometry turning_geometry_of(const params::Machine& machine, const Vector3& tool_offset_mm);

/// Where its tool is, in the frame of the workpiece.
struct TurningPose {
  Vector3 nominal_mm{};
  Vector3 error_um{};
  std::array<Vector3, kAxes> bed{};   ///< X, Y, Z of the bed
  std::array<Vector3, kAxes> tool{};  ///< those of the tool at angles of 0
};

/// Tool against workpiece, actual − nominal.
struct ToolPose {
  Vector3 error_um{};           ///< of the tool point, along X, Y, Z
  Vector3 rotation_um_per_m{};  ///< of the tool, about X, Y, Z (rotation vector)
};
/// The error in that sense, um or um/m.
[[nodiscard]] inline double seen(const ToolPose& pose, Sense sense) {
  const std::size_t direction = index_of(direction_of(sense));
  return is_rotation(sense) ? pose.rotation_um_per_m[direction] : pose.error_um[direction];
}

/// Tool side, carriage a:       T_a(v) = u_a·p_a + δ_a + R(ε_a)(v − c_a) + c_a
/// Workpiece side, carriage a:  M_a(v) = δ_a + R(ε_a)(v + u_a·p_a − c_a) + c_a
/// Point = M_outermost(… M_base(T_1(… T_n(tool offset)))), u_a tilted by the squareness errors (u_X = X).
/// @param errors       the carriages' own errors (CurveKind::carriage) at this position [um, um/m]
/// @param position_mm  coordinate of each axis; axes that do not exist do not count
[[nodiscard]] ToolPose tool_pose(const ChainGeometry& geometry, const ComponentValues& errors,
                                 const Vector3& position_mm);

/// Linear carriages as above; a rotary axis r with its pivot c, its angle a about n:
/// Tool side:       T_r = Λ_r Δ_r R(a n), about c        Λ_r: shift and turn of its axis line, Δ_r: of its error
/// motion;
///                  before the first T the shift of a machine that bends
/// Workpiece side:  M_r = R(a n) Λ_r Δ_r
/// @param errors  of the linear carriages at this position
[[nodiscard]] TurningPose turning_pose(const TurningGeometry& geometry, const ComponentValues& errors,
                                       const RotaryValues& rotary, const Vector3& position_mm,
                                       const Vector3& angle_deg);

}  // namespace ecs::emulator
