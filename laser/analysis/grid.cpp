// Curves on uniform grids.
#include <cmath>

#include <fmt/format.h>

#include "laser/analysis/curve_side.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::laser {
namespace {

constexpr int kMostPoints = 1'000'000;

bool is_usable(const Grid& grid) {
  return std::isfinite(grid.start_mm) && std::isfinite(grid.increment_mm) && grid.increment_mm > 0.0 &&
         grid.count >= 1 && grid.count <= kMostPoints;
}

double position_of(const Grid& grid, int k) { return grid.start_mm + grid.increment_mm * k; }

}  // namespace

Result<Curve> resampled(const Curve& curve, const Grid& grid, Beyond beyond) {
  if (!is_usable(grid))
    return problem(ProblemKind::usage, "a grid needs an increment above 0 mm and 1 to 1 000 000 points");
  if (curve.points.empty()) return problem(ProblemKind::refused, "a curve without points cannot be put on a grid");
  const auto forward = side_of(curve, Side::forward);
  const auto reverse = side_of(curve, Side::reverse);
  const bool hold = beyond == Beyond::hold_end_value;
  Curve result = curve;
  result.points.clear();
  for (int k = 0; k < grid.count; ++k) {
    CurvePoint point;
    point.position_mm = position_of(grid, k);
    set_side(point, Side::forward, point_at(forward, point.position_mm, curve.merge_tolerance_mm, hold));
    set_side(point, Side::reverse, point_at(reverse, point.position_mm, curve.merge_tolerance_mm, hold));
    if (point.forward.has_value() == forward.empty() || point.reverse.has_value() == reverse.empty())
      return problem(ProblemKind::refused,
                     fmt::format("the grid point {} mm lies outside the measured travel {} to {} mm of an approach",
                                 point.position_mm, curve.points.front().position_mm, curve.points.back().position_mm));
    result.points.push_back(point);
  }
  return result;
}

std::optional<Grid> uniform_grid_of(const Curve& curve) {
  if (curve.points.size() < 2 || curve.points.size() > kMostPoints) return std::nullopt;
  const int count = static_cast<int>(curve.points.size());
  const double first_mm = curve.points.front().position_mm;
  const Grid grid{first_mm, (curve.points.back().position_mm - first_mm) / (count - 1), count};
  for (int k = 0; k < count; ++k)
    if (std::abs(curve.points[static_cast<std::size_t>(k)].position_mm - position_of(grid, k)) >
        curve.merge_tolerance_mm)
      return std::nullopt;
  return grid;
}

}  // namespace ecs::laser
