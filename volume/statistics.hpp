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
  ErrorSize all;
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

}  // namespace ecs::volume
