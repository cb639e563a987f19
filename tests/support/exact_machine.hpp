// A machine tool as rigid bodies, with exact rotation matrices: the oracle of the linearised term table.
// Written from the definition (docs/physics.md, rigid-body model) and shares no code with core/ but its plain types.
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "core/axis.hpp"
#include "core/terms.hpp"

namespace ecs::test {

/// What is wrong with the machine at one pose, and how its errors are referred.
struct MachineErrors {
  ComponentValues values{};     ///< um, um/m; the curves at the present positions
  MeasurementLines lines_mm{};  ///< through which point each carriage turns, lever directions only
  Vector3 tool_offset_mm{};
};

/// Tool point minus commanded tool point, in the frame of the workpiece [um].
/// Tool-side carriages carry what follows them; workpiece-side carriages carry the table the other way:
/// "error" is that of the tool relative to the workpiece, so such a carriage moves by −(p + δ) and turns by −ε.
[[nodiscard]] Vector3 exact_error_um(const std::string& configuration, const MachineErrors& errors,
                                     const Vector3& position_mm);

}  // namespace ecs::test
