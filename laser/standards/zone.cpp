// Minimum zone: its width is a convex function of the two slopes, so that golden sections, one inside the other, find
// its least value (Kiefer 1953).
#include "laser/standards/zone.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <Eigen/Core>

#include "base/linear/decompositions.hpp"

namespace ecs::laser {
namespace {

constexpr double kGolden = 0.6180339887498949;
/// Sections after which a range is 1e-9 of what it was.
constexpr int kSections = 44;

Zone zone_at(const std::vector<ZonePoint>& points, double per_u, double per_v) {
  Zone zone{per_u, per_v, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const ZonePoint& point : points) {
    const double value = point.value - per_u * point.u - per_v * point.v;
    zone.least = std::min(zone.least, value);
    zone.greatest = std::max(zone.greatest, value);
  }
  return zone;
}

/// The narrowest of the zones that `zone_of` gives over from … to.
template <class ZoneOf>
Zone narrowest(double from, double to, const ZoneOf& zone_of) {
  double low = to - kGolden * (to - from), high = from + kGolden * (to - from);
  Zone at_low = zone_of(low), at_high = zone_of(high);
  for (int i = 0; i < kSections; ++i) {
    if (at_low.width() <= at_high.width()) {
      to = std::exchange(high, low);
      at_high = at_low;
      low = to - kGolden * (to - from);
      at_low = zone_of(low);
    } else {
      from = std::exchange(low, high);
      at_low = at_high;
      high = from + kGolden * (to - from);
      at_high = zone_of(high);
    }
  }
  return at_low.width() <= at_high.width() ? at_low : at_high;
}

}  // namespace

Zone least_squares_zone(const std::vector<ZonePoint>& points) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::VectorXd values(columns.rows());
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const ZonePoint& point = points[static_cast<std::size_t>(i)];
    columns.row(i) << 1.0, point.u, point.v;
    values[i] = point.value;
  }
  const Eigen::VectorXd plane = least_squares(columns, values).sizes;
  return zone_at(points, plane[1], plane[2]);
}

Zone minimum_zone(const std::vector<ZonePoint>& points) {
  const Zone start = least_squares_zone(points);
  double half_u = 0.0, half_v = 0.0;
  {  // A slope further from least squares than this widens the zone more than it can ever narrow it.
    const auto [least_u, most_u] = std::ranges::minmax_element(points, [](auto& a, auto& b) { return a.u < b.u; });
    const auto [least_v, most_v] = std::ranges::minmax_element(points, [](auto& a, auto& b) { return a.v < b.v; });
    half_u = 4.0 * start.width() / (most_u->u - least_u->u);
    half_v = 4.0 * start.width() / (most_v->v - least_v->v);
  }
  return narrowest(start.per_u - half_u, start.per_u + half_u, [&](double per_u) {
    return narrowest(start.per_v - half_v, start.per_v + half_v,
                     [&](double per_v) { return zone_at(points, per_u, per_v); });
  });
}

}  // namespace ecs::laser
