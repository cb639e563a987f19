// The error vector of a machine anywhere in its working volume, as it is and with a unit that compensates it by a map.
// Does not live here: files (commissioning/volume), pictures (commissioning/volume/figures.hpp).
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "volume/rotary_errors.hpp"
#include "volume/statistics.hpp"

namespace ecs::volume {

/// A place, and the side from which all axes arrived: kSides.
struct Place {
  Vector3 position_mm{};
  std::size_t side = 1;
};

/// Where the errors of the machine are known from: components along its axes, or vectors at places. One of them.
struct ErrorSource {
  /// Errors at the coordinates of a grid [um, um/m].
  std::function<Result<Components>(const Grid&)> components;
  /// How the tool sees them.
  Kinematics kinematics{};
  CurveKind curves = CurveKind::measured;  ///< what their translations hold
  /// Errors at places [um]; the tool offset is theirs to know.
  std::function<Result<std::vector<Vector3>>(const std::vector<Place>&)> vectors;
};

/// The rotary axes of a machine. A unit knows nothing of them: it compensates X, Y and Z as with all angles at 0.
struct RotaryAxes {
  kinematics::JointMachine machine;  ///< chain, terms, directions and pivots; the rest comes from the source of errors
  RotaryErrors errors;
  std::array<std::optional<std::array<double, 2>>, kAxes> travel_deg{};  ///< of A, B, C
  kinematics::Angles angles_deg{};                                       ///< the setting for errors_over()
};

/// A machine, its map and the unit that compensates it.
struct CompensatedMachine {
  laser::ErrorMap map;
  UnitParameters parameters;
  Travels travel_mm{};
  Vector3 tool_offset_mm{};  ///< of the tool in use; the unit compensates for that of its parameters
  ErrorSource errors;
  std::optional<RotaryAxes> rotary;  ///< then errors are vectors in the frame of the workpiece
};

/// Every term of the chain in the directions that have an axis. Empty if the parameters describe no machine.
[[nodiscard]] TermTable terms_of_machine(const UnitParameters& parameters, Convention convention, CurveKind curves);

/// The errors that the map of a machine says it has, as a source of errors.
[[nodiscard]] ErrorSource errors_of_map(const laser::ErrorMap& map, const UnitParameters& parameters,
                                        const Vector3& tool_offset_mm);

/// Errors counted from the reference position, mean of both sides: a constant shift is in every work offset.
struct BeforeAfter {
  VolumeError before;
  VolumeError after;
};

/// What the unit adds over a grid, by its scope and its tool offset.
[[nodiscard]] Field compensation_over(const CompensatedMachine& machine, const Grid& grid);

[[nodiscard]] Vector3 reference_of(const UnitParameters& parameters);

/// At every place of a grid.
[[nodiscard]] Result<BeforeAfter> errors_over(const CompensatedMachine& machine, const Grid& grid);

struct VolumeAnswer {
  Grid grid;
  BeforeAfter errors;  ///< over the grid; with rotary axes in the setting with the largest error
  std::vector<kinematics::Angles>
      settings;  ///< of the rotary axes, each with every place of the grid; none: no such axes
  VolumeSize before;
  VolumeSize after;
};

/// At most `places` places, the settings of rotary axes counted, and the body diagonals.
[[nodiscard]] Result<VolumeAnswer> evaluated(const CompensatedMachine& machine, std::size_t places);

}  // namespace ecs::volume
