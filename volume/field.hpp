// The error vector over a grid as sums of what one axis contributes: each term of core/terms.hpp reads one curve and at
// most one lever, so that a place costs a dozen products however many components there are.
//   E_d(p) = Σ_b [ c_bd(p_b) + Σ_{l≠b} s_bdl(p_b)·p_l ] + Σ_l q_dl·p_l        d, b, l: axes; c [um], s and q [um/mm]
// Agrees with exact homogeneous matrices to second order in the errors (tests/volume/exact_machine_test.cpp).
// Source: thesis 4.3; R. Schultschik, The components of volumetric accuracy, CIRP Annals 25 (1977) 223.
// Does not live here: the statistics of a volume (statistics.hpp).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinematics/machine_pose.hpp"
#include "volume/components.hpp"

namespace ecs::volume {

/// How components act at the tool.
struct Kinematics {
  TermTable terms{};
  MeasurementLines lines_mm{};
  Vector3 tool_offset_mm{};  ///< from the point at which the curves were measured to the tool point
};

class Field {
 public:
  /// @param components  made for this grid
  Field(const Grid& grid, const Components& components, const Kinematics& kinematics);

  /// With the rotary axes of a machine at the angles of `pose`, in the frame of the workpiece.
  /// @param rotary  by side: values of the rotary axes there
  Field(const Grid& grid, const Components& components, const kinematics::MachinePose& pose,
        const std::array<kinematics::JointValues, 2>& rotary);

  /// Another field of the same grid beside this one: what compensation adds.
  void add(const Field& other);
  /// From now on the error is zero at the reference of the grid, mean of both approaches.
  void count_from_reference();
  /// Adds the same vector everywhere.
  void shift(const Vector3& by_um);
  /// The same vectors with their X, Y, Z along these directions.
  [[nodiscard]] Field along(const std::array<Vector3, kAxes>& directions) const;

  /// Error vector [um], all axes having arrived by that side.
  [[nodiscard]] Vector3 at(std::size_t side, const GridIndex& index) const;
  /// The same at the reference of the grid.
  [[nodiscard]] Vector3 at_reference(std::size_t side) const;
  /// At every coordinate of Z for one of X and one of Y. @param out  as many as coordinates of Z
  void row(std::size_t side, std::size_t x, std::size_t y, std::span<Vector3> out) const;

  [[nodiscard]] const Grid& grid() const { return grid_; }

 private:
  /// What one axis contributes at one of its coordinates.
  struct Part {
    Vector3 constant{};                  ///< [um]
    std::array<Vector3, kAxes> slope{};  ///< by lever [um/mm]
  };
  [[nodiscard]] Vector3 sum(const PerAxis<const Part*>& parts, const Vector3& place_mm) const;
  void reserve();
  void put(const kinematics::MachinePose& pose, const Components& components);
  void put(const kinematics::MachinePose& pose, std::size_t side, const kinematics::JointValues& rotary);
  void put(const Term& term, const Components& components, const Kinematics& kinematics);

  Grid grid_;
  std::array<PerAxis<std::vector<Part>>, 2> part_;  ///< `[side][axis]`: at its coordinates, then at the reference
  std::array<Vector3, kAxes> squareness_{};         ///< by lever [um/mm]
};

}  // namespace ecs::volume
