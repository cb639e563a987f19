// Where the tool really is: the chain of carriages as exact matrices, not linearised (thesis 4.3, equations 5-19).
// Does not live here: how large the errors are (true_errors.hpp), how they are measured
// (ecs_emulator/instruments/laser.hpp).
#pragma once

#include "core/chain.hpp"
#include "core/terms.hpp"

namespace ecs::emulator {

/// The machine's geometry apart from its errors.
struct ChainGeometry {
  Chain chain{};
  MeasurementLines
      lines_mm{};  ///< each axis's rotation acts about this point; coordinates that are no lever count as 0
  Vector3 tool_offset_mm{};
};

/// Tool against workpiece, actual − nominal.
struct ToolPose {
  Vector3 error_um{};           ///< of the tool point, along X, Y, Z
  Vector3 rotation_um_per_m{};  ///< of the tool, about X, Y, Z (rotation vector)
};

/// Tool side, carriage a:       T_a(v) = u_a·p_a + δ_a + R(ε_a)(v − c_a) + c_a
/// Workpiece side, carriage a:  M_a(v) = δ_a + R(ε_a)(v + u_a·p_a − c_a) + c_a
/// Point = M_outermost(… M_base(T_1(… T_n(tool offset)))), u_a tilted by the squareness errors (u_X = X).
/// @param errors       the carriages' own errors (CurveKind::carriage) at this position [um, um/m]
/// @param position_mm  coordinate of each axis; axes that do not exist do not count
[[nodiscard]] ToolPose tool_pose(const ChainGeometry& geometry, const ComponentValues& errors,
                                 const Vector3& position_mm);

}  // namespace ecs::emulator
