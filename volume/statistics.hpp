// How large the error of a volume is: largest, 95 %, root mean square; on edges, faces and body diagonals.
// Does not live here: the error itself (field.hpp), how certain it is (uncertainty.hpp).
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "volume/field.hpp"

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
  ErrorSize all;
  ErrorSize faces;      ///< at least one axis at an end of its travel
  ErrorSize edges;      ///< all axes but one at an end
  ErrorSize diagonals;  ///< from corner to opposite corner, kDiagonalPlaces each
};

inline constexpr std::size_t kDiagonalPlaces = 101;

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

}  // namespace ecs::volume
