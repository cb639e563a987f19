#include "volume/grid.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::volume {
namespace {

Grid empty_grid(const Travels& travel_mm, const Vector3& reference_mm) {
  Grid grid;
  grid.reference_mm = reference_mm;
  for (std::size_t a = 0; a < kAxes; ++a) grid.exists[a] = travel_mm[a].has_value();
  return grid;
}

std::vector<double> steps(const std::optional<std::array<double, 2>>& travel_mm, std::size_t count) {
  if (!travel_mm) return {0.0};
  std::vector<double> mm(count);
  for (std::size_t i = 0; i < count; ++i)
    mm[i] = std::lerp((*travel_mm)[0], (*travel_mm)[1], static_cast<double>(i) / static_cast<double>(count - 1));
  return mm;
}

}  // namespace

std::size_t Grid::axes() const { return static_cast<std::size_t>(std::count(exists.begin(), exists.end(), true)); }

std::size_t Grid::axes_at_an_end(const GridIndex& index) const {
  std::size_t count = 0;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (exists[a] && (index[a] == 0 || index[a] + 1 == mm[a].size())) ++count;
  return count;
}

Grid grid_over(const Travels& travel_mm, std::size_t places, const Vector3& reference_mm) {
  Grid grid = empty_grid(travel_mm, reference_mm);
  std::vector<std::size_t> axes;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (travel_mm[a]) axes.push_back(a);
  const auto length = [&](std::size_t a) { return (*travel_mm[a])[1] - (*travel_mm[a])[0]; };
  std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  const double root =
      std::pow(static_cast<double>(places), 1.0 / static_cast<double>(std::max<std::size_t>(1, axes.size())));
  PerAxis<std::size_t> count{1, 1, 1};
  for (const std::size_t a : axes) count[a] = std::max<std::size_t>(2, static_cast<std::size_t>(root + 1e-9));
  for (const std::size_t a : axes)  // one step more while there is room
    if (count[0] * count[1] * count[2] / count[a] * (count[a] + 1) <= places) ++count[a];
  for (std::size_t a = 0; a < kAxes; ++a) grid.mm[a] = steps(travel_mm[a], count[a]);
  return grid;
}

Grid even_grid(const Travels& travel_mm, std::size_t count, const Vector3& reference_mm) {
  Grid grid = empty_grid(travel_mm, reference_mm);
  for (std::size_t a = 0; a < kAxes; ++a) grid.mm[a] = steps(travel_mm[a], count);
  return grid;
}

Grid grid_at(const Travels& travel_mm, const Vector3& place_mm, const Vector3& reference_mm) {
  Grid grid = empty_grid(travel_mm, reference_mm);
  for (std::size_t a = 0; a < kAxes; ++a) grid.mm[a] = {travel_mm[a] ? place_mm[a] : 0.0};
  return grid;
}

}  // namespace ecs::volume
