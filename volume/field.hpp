// The places of a working volume at which its error is evaluated, the error components of a machine along its axes
// there (what a map says, what a unit adds), and the error vector over that grid as sums of what one axis contributes:
// each term of core/terms.hpp reads one curve and at most one lever, so that a place costs a dozen products however
// many components there are.
//   E_d(p) = Σ_b [ c_bd(p_b) + Σ_{l≠b} s_bdl(p_b)·p_l ] + Σ_l q_dl·p_l        d, b, l: axes; c [um], s and q [um/mm]
// Agrees with exact homogeneous matrices to second order in the errors (tests/volume/volume_test.cpp).
// Source: thesis 4.3; R. Schultschik, The components of volumetric accuracy, CIRP Annals 25 (1977) 223.
// Does not live here: the statistics of a volume (volume.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/axis.hpp"
#include "core/tick.hpp"
#include "kinematics/machine_pose.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::volume {

/// Lower and upper end of the travel of each axis that exists, machine coordinates [mm].
using Travels = PerAxis<std::optional<std::array<double, 2>>>;

/// A place by its coordinates' numbers in a Grid.
using GridIndex = PerAxis<std::size_t>;

/// Every combination of one coordinate of each axis.
struct Grid {
  PerAxis<std::vector<double>> mm;  ///< ascending, the ends of the travel among them; one, 0, where there is no axis
  PerAxis<bool> exists{};
  Vector3 reference_mm{};  ///< the place from which errors count

  [[nodiscard]] std::size_t places() const { return mm[0].size() * mm[1].size() * mm[2].size(); }
  [[nodiscard]] Vector3 at(const GridIndex& index) const { return {mm[0][index[0]], mm[1][index[1]], mm[2][index[2]]}; }
  /// The axes that stand at an end of their travel there.
  [[nodiscard]] std::size_t axes_at_an_end(const GridIndex& index) const;
  [[nodiscard]] std::size_t axes() const;
};

inline constexpr std::size_t kMostPlaces = 5'000'000;

/// Even steps over the travels, about as many on each axis: at most `places` in all, at least two on each axis.
[[nodiscard]] Grid grid_over(const Travels& travel_mm, std::size_t places, const Vector3& reference_mm);

/// `count` even steps on each axis: places of equal numbers are those of a body diagonal.
[[nodiscard]] Grid even_grid(const Travels& travel_mm, std::size_t count, const Vector3& reference_mm);

/// One place alone.
[[nodiscard]] Grid grid_at(const Travels& travel_mm, const Vector3& place_mm, const Vector3& reference_mm);

inline constexpr std::array<Approach, 2> kSides{Approach::reverse, Approach::forward};  ///< in the order of side_of()

/// Values of the components [um, um/m].
struct Components {
  /// `[side][curve]`: at each coordinate of the curve's axis in the grid, then at the reference; empty: zero there.
  std::array<std::array<std::vector<double>, kCurves>, 2> curve;
  ComponentValues squareness{};  ///< of C0Y, B0Z, A0Z
};

/// Coordinates of an axis in a grid, then its reference position.
[[nodiscard]] std::vector<double> coordinates_of(const Grid& grid, Axis axis);

/// The errors that a map and the squareness of the parameters say the machine has: minus the compensation, straight
/// between the points, end values beyond the ends. What the map does not hold is zero.
[[nodiscard]] Components errors_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid);

/// What a unit with these parameters adds, before their scope: interpolation and angular scale as they say.
[[nodiscard]] Components compensation_in(const laser::ErrorMap& map, const UnitParameters& parameters,
                                         const Grid& grid);

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
