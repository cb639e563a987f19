// The places of a working volume at which its error is evaluated.
// Does not live here: the error there (field.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/axis.hpp"

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

}  // namespace ecs::volume
