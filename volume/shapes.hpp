// Where a coordinate lies on a curve of a map: between which values, and on the smooth shapes along the travel.
// Does not live here: how large they are (uncertainty.hpp).
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "laser/map/error_map.hpp"
#include "volume/grid.hpp"

namespace ecs::volume {

/// Smooth shapes of mean square 1 together: an offset (half), a straight line (a quarter), one and two waves along the
/// travel (a quarter).
using Shapes = std::array<double, 6>;
[[nodiscard]] inline Shapes shapes_at(const std::array<double, 2>& travel_mm, double position_mm) {
  const double t = (position_mm - travel_mm[0]) / (travel_mm[1] - travel_mm[0]);
  const double turn = 2.0 * std::numbers::pi * t, wave = std::sqrt(0.125);
  return {std::sqrt(0.5),        std::sqrt(0.75) * (2.0 * t - 1.0), wave * std::cos(turn),
          wave * std::sin(turn), wave * std::cos(2.0 * turn),       wave * std::sin(2.0 * turn)};
}

/// Place between two values of a table.
struct TablePlace {
  std::size_t below = 0;
  double part = 0.0;  ///< of the way to the next value
  /// Of the bow between the two: 1 midway.
  [[nodiscard]] double bow() const { return 4.0 * part * (1.0 - part); }
};
[[nodiscard]] inline TablePlace place_in(const laser::MapTable& table, double position_mm) {
  const auto& p = table.position_mm;
  if (p.size() < 2 || position_mm <= p.front()) return {};
  const auto next = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), position_mm) - p.begin());
  if (next == p.size()) return {p.size() - 2, 1.0};
  return {next - 1, (position_mm - p[next - 1]) / (p[next] - p[next - 1])};
}

}  // namespace ecs::volume
