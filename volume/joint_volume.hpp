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

/// A vector of the machine's frame, given along X, Y, Z as the rotary axes turn them.
[[nodiscard]] Vector3 along_axes(const std::array<Vector3, kAxes>& along, const Vector3& v);

/// Values of linear and rotary axes as the chain carries them to the tool, for any angles. Those of the linear axes
/// count from the reference position in the machine's frame, as pivots are measured there; the sum counts from the
/// reference angles.
class ChainOver {
 public:
  /// @param components  made for this grid
  ChainOver(kinematics::JointMachine machine, const Kinematics& linear, const Grid& grid, Components components,
            RotaryErrors rotary, const kinematics::Angles& from_deg);

  [[nodiscard]] Field at(const kinematics::Angles& angles_deg) const;
  /// Tool against workpiece, by side, at the first place of the grid [um/m].
  [[nodiscard]] std::array<Vector3, 2> orientation_at(const kinematics::Angles& angles_deg) const;
  [[nodiscard]] const kinematics::JointMachine& machine() const { return machine_; }

 private:
  [[nodiscard]] Field from_reference(const kinematics::Angles& angles_deg) const;

  Grid grid_;
  kinematics::JointMachine machine_;
  RotaryErrors rotary_;
  Components components_;
  Vector3 at_reference_{};  ///< of the linear axes there, mean of both sides
  Vector3 at_zero_{};       ///< what rotary axes contribute at the reference and the reference angles
};

/// A machine over one grid, for any angles: its errors, and what its unit adds. A map with rotary axes is added by the
/// same chain as the errors; any other is along X, Y, Z as with all angles at 0.
class JointVolume {
 public:
  /// @pre machine.rotary, and its errors are components
  [[nodiscard]] static Result<JointVolume> over(const CompensatedMachine& machine, const Grid& grid);

  /// Errors on their own, without a map: `components` made for this grid.
  [[nodiscard]] static JointVolume of(const CompensatedMachine& machine, const Grid& grid, Components components,
                                      RotaryErrors rotary);

  [[nodiscard]] BeforeAfter at(const kinematics::Angles& angles_deg) const;
  /// Those before compensation.
  [[nodiscard]] Field errors(const kinematics::Angles& angles_deg) const { return errors_.at(angles_deg); }
  /// Tool against workpiece, by side, at the first place of the grid [um/m]; the unit compensates none of it.
  [[nodiscard]] std::array<Vector3, 2> orientation_at(const kinematics::Angles& angles_deg) const {
    return errors_.orientation_at(angles_deg);
  }

 private:
  ChainOver errors_;
  std::optional<ChainOver> whole_;  ///< what the unit adds by a map with rotary axes
  std::optional<Field> linear_;     ///< by any other map: along the linear axes, counted from the reference

  explicit JointVolume(ChainOver errors) : errors_(std::move(errors)) {}
};

/// At most `places` places, those of the linear axes times the settings.
[[nodiscard]] Result<VolumeAnswer> evaluated_with_rotary(const CompensatedMachine& machine, std::size_t places);

}  // namespace ecs::volume
