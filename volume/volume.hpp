// The error vector of a machine anywhere in its working volume, as it is and with a unit that compensates it by a map;
// how large it is (largest, 95 %, root mean square; on edges, faces and body diagonals), and the largest between the
// places of a grid: a jump or a short wave falls between even places unseen.
// Does not live here: the error itself (field.hpp), how certain it is (uncertainty.hpp), files (commissioning/volume).
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "volume/field.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::volume {

/// The error of a machine over a grid: the sum of a field and of vectors, each of which may be absent.
struct VolumeError {
  std::optional<Field> field;
  /// [um]: at every place (X slowest, Z fastest; of diagonals in the order of for_each_diagonal_place) by the reverse
  /// side, then by the forward side; counted from the reference.
  std::vector<Vector3> vectors;

  [[nodiscard]] Vector3 at(const Grid& grid, std::size_t side, const GridIndex& index) const;
};

/// Sizes of error vectors at a set of places, each reached from both sides [um].
struct ErrorSize {
  std::size_t places = 0;
  std::size_t setting = 0;  ///< of rotary axes, in which the largest is: number of the field that was counted
  double largest_um = 0.0;
  double p95_um = 0.0;                    ///< 95 of 100 vectors are no longer
  double rms_um = 0.0;                    ///< √(mean length²)
  Vector3 at_mm{};                        ///< where the largest is
  Approach approach = Approach::forward;  ///< how all axes arrived there
  Vector3 error_um{};                     ///< the largest itself
  Vector3 largest_along_um{};             ///< of |error| along X, Y, Z
  Vector3 rms_along_um{};
};

struct VolumeSize {
  ErrorSize all;        ///< on the grid; its largest also of the diagonals
  ErrorSize faces;      ///< at least one axis at an end of its travel
  ErrorSize edges;      ///< all axes but one at an end
  ErrorSize diagonals;  ///< from corner to opposite corner, kDiagonalPlaces each
};

inline constexpr std::size_t kDiagonalPlaces = 101;

/// Takes error vectors one by one.
class SizeCounter {
 public:
  explicit SizeCounter(std::size_t vectors) { lengths_.reserve(vectors); }
  void take(const Vector3& error_um, const Vector3& place_mm, std::size_t side, std::size_t setting);
  [[nodiscard]] ErrorSize finish();

 private:
  ErrorSize size_;
  Vector3 squares_{};
  std::vector<float> lengths_;
};

/// Sizes over one field after the other, each of the same grid: the settings of rotary axes.
class VolumeCounter {
 public:
  explicit VolumeCounter(std::size_t places) : all_(2 * places) {}
  /// Parameters as of size_of().
  void take(const Grid& grid, const VolumeError& error, const Grid& diagonals, const VolumeError& error_on_diagonals);
  [[nodiscard]] VolumeSize finish();

 private:
  SizeCounter all_, faces_{0}, edges_{0}, on_diagonals_{0};
  std::size_t settings_ = 0;
};

/// @param diagonals  even_grid() of kDiagonalPlaces over the same travels
/// @param error_on_diagonals  at its places, see for_each_diagonal_place()
[[nodiscard]] VolumeSize size_of(const Grid& grid, const VolumeError& error, const Grid& diagonals,
                                 const VolumeError& error_on_diagonals);

/// Sizes at all places of a grid.
[[nodiscard]] ErrorSize size_of(const Grid& grid, const VolumeError& error);

/// The places of the body diagonals, one diagonal after the other.
/// @param each  number of the place, counted over all diagonals
void for_each_diagonal_place(const Grid& diagonals,
                             const std::function<void(std::size_t number, const GridIndex& index)>& each);

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

/// The rotary axes of a machine. A map without them compensates X, Y and Z as with all angles at 0.
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

inline constexpr std::size_t kPlacesOfLine = 2001;  ///< 0.5 mm apart on an axis of a metre

/// The largest error on lines along each axis through `from`, from there again, until no line holds a larger one: no
/// smaller than `from`. Rotary axes stand at the angles of the machine.
/// @param of  before or after compensation: &BeforeAfter::before, &BeforeAfter::after
[[nodiscard]] Result<ErrorSize> largest_between(const CompensatedMachine& machine, const ErrorSize& from,
                                                VolumeError BeforeAfter::*of);

}  // namespace ecs::volume
