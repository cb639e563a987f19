// The error components of a machine along its axes, at the coordinates of a grid: what a map says, what a unit adds.
// Does not live here: how they add up at the tool (field.hpp).
#pragma once

#include <array>
#include <vector>

#include "core/compiled_map.hpp"
#include "laser/map/error_map.hpp"
#include "volume/grid.hpp"

namespace ecs::volume {

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

}  // namespace ecs::volume
