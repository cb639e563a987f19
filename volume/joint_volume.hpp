// The error vector over a grid of linear axes while the rotary axes stand at an angle, one setting after the other: for
// each the sum of field.hpp with the terms of kinematics/, in the frame of the workpiece.
// Does not live here: errors of a machine without rotary axes (volume.hpp).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "volume/rotary_errors.hpp"
#include "volume/volume.hpp"

namespace ecs::volume {

/// Settings of rotary axes: every combination of these angles. A whole turn is not ended by its beginning.
[[nodiscard]] std::vector<kinematics::Angles> settings_over(const RotaryAxes& rotary, std::size_t on_each);

/// Where errors count from: 0, or the end of the travel nearest to it.
[[nodiscard]] kinematics::Angles reference_angles(const RotaryAxes& rotary);

/// A machine over one grid, for any angles. Errors of the linear axes and what the unit adds count from the reference
/// position in the machine's frame, as pivots are measured there; the sum counts from the reference angles.
class JointVolume {
 public:
  /// @pre machine.rotary, and its errors are components
  [[nodiscard]] static Result<JointVolume> over(const CompensatedMachine& machine, const Grid& grid);

  /// Errors on their own, without a map: `components` made for this grid.
  [[nodiscard]] static JointVolume of(const CompensatedMachine& machine, const Grid& grid, Components components,
                                      RotaryErrors rotary);

  [[nodiscard]] BeforeAfter at(const kinematics::Angles& angles_deg) const;
  /// Those before compensation.
  [[nodiscard]] Field errors(const kinematics::Angles& angles_deg) const;
  /// Tool against workpiece, by side, at the first place of the grid [um/m]; the unit compensates none of it.
  [[nodiscard]] std::array<Vector3, 2> orientation_at(const kinematics::Angles& angles_deg) const;

 private:
  JointVolume(const CompensatedMachine& machine, const Grid& grid, Components components, RotaryErrors rotary,
              Field compensation);
  [[nodiscard]] Field errors_at(const kinematics::MachinePose& pose, const kinematics::Angles& angles_deg) const;

  Grid grid_;
  kinematics::JointMachine machine_;
  RotaryErrors rotary_;
  Components components_;
  Field compensation_;      ///< along the linear axes, counted from the reference
  Vector3 at_reference_{};  ///< errors of the linear axes there, mean of both sides
  Vector3 at_zero_{};       ///< what rotary axes contribute at the reference and the reference angles
};

/// At most `places` places, those of the linear axes times the settings.
[[nodiscard]] Result<VolumeAnswer> evaluated_with_rotary(const CompensatedMachine& machine, std::size_t places);

}  // namespace ecs::volume
