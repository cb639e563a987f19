// The minimum zone: the narrowest band between two parallel planes, or two concentric circles, that holds all points.
#pragma once

#include <vector>

namespace ecs::laser {

/// A value over two linear coordinates: height over x and y, or radial deviation over cos and sin of the angle.
struct ZonePoint {
  double u = 0.0;
  double v = 0.0;
  double value = 0.0;
};

struct Zone {
  double per_u = 0.0;
  double per_v = 0.0;
  double least = 0.0;     ///< smallest value − per_u·u − per_v·v
  double greatest = 0.0;  ///< greatest
  [[nodiscard]] double width() const { return greatest - least; }
};

/// The zone of least width (ISO 1101 minimum zone). Of a circle the slopes are the shift of its centre; exact to
/// (shift / radius)², below 1e-6 for what a machine tool errs.
/// @param points  at least three, of which u and v do not all lie on one line
[[nodiscard]] Zone minimum_zone(const std::vector<ZonePoint>& points);
/// The zone about the plane, or circle, of least squares.
[[nodiscard]] Zone least_squares_zone(const std::vector<ZonePoint>& points);

}  // namespace ecs::laser
