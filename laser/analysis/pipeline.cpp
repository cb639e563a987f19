// Outliers of a measured line. Each reading is compared with the mean of the others of its target and approach; the
// scale is the median of these distances (median absolute deviation; F. R. Hampel, J. Am. Stat. Assoc. 69 (1974) 383).
#include "laser/analysis/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace ecs::laser {
namespace {

/// Readings of one target and approach.
using Cell = std::vector<std::size_t>;

std::vector<Cell> cells_of(const MeasurementSet& set, const Group& group) {
  std::vector<std::size_t> order = group.readings;
  const auto at = [&](std::size_t i) { return target_of(set.readings[i]); };
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return at(a) < at(b); });
  const double tolerance_mm = target_tolerance_mm(set, group);
  std::vector<Cell> cells;
  std::map<Approach, Cell> here;
  double first_mm = 0.0;
  const auto close = [&] {
    for (auto& [approach, cell] : here) cells.push_back(std::move(cell));
    here.clear();
  };
  for (const std::size_t i : order) {
    if (here.empty() || at(i) - first_mm > tolerance_mm) {
      close();
      first_mm = at(i);
    }
    here[set.readings[i].approach].push_back(i);
  }
  close();
  return cells;
}

/// From the mean of the other readings of the cell.
double distance_in(const MeasurementSet& set, const Cell& cell, std::size_t reading) {
  double sum = 0.0;
  for (const std::size_t other : cell)
    if (other != reading) sum += set.readings[other].error;
  return set.readings[reading].error - sum / static_cast<double>(cell.size() - 1);
}

}  // namespace

std::vector<std::size_t> outliers_of(const MeasurementSet& set, const Group& group) {
  constexpr double kUsual = 1.4826;  // standard deviation over median distance of a normal distribution
  constexpr double kFar = 5.0;       // one reading in 1.7 million by chance
  constexpr std::size_t kLeast = 3;  // below, it is not known which reading is apart
  const auto cells = cells_of(set, group);
  std::vector<double> distances;
  for (const Cell& cell : cells)
    if (cell.size() >= kLeast)
      for (const std::size_t i : cell) distances.push_back(std::abs(distance_in(set, cell, i)));
  const double far = kFar * kUsual * median_of(distances);
  std::vector<std::size_t> outliers;
  if (far <= 0.0) return outliers;
  for (const Cell& cell : cells) {
    if (cell.size() < kLeast) continue;
    const auto farthest = *std::ranges::max_element(cell, [&](std::size_t a, std::size_t b) {
      return std::abs(distance_in(set, cell, a)) < std::abs(distance_in(set, cell, b));
    });
    if (std::abs(distance_in(set, cell, farthest)) > far) outliers.push_back(farthest);
  }
  std::ranges::sort(outliers);
  return outliers;
}

namespace {

double range_of(const MeasurementSet& set) {
  const auto [least, most] =
      std::ranges::minmax_element(set.readings, [](const Reading& a, const Reading& b) { return a.error < b.error; });
  return most->error - least->error;
}

}  // namespace

Result<ProcessedCurve> processed(const Curve& curve, const CurveSteps& steps) {
  ECS_TRY(level, levelled(curve, steps.slope));
  ProcessedCurve out{std::move(level), std::nullopt, std::nullopt};
  if (steps.smoothing_mm <= 0.0) return out;
  Smoothing how;
  how.window_mm = steps.smoothing_mm;
  auto smooth = smoothed(out.level.curve, how);
  if (smooth)
    out.smooth = std::move(*smooth);
  else
    out.smoothing_fault = std::move(smooth.error());
  return out;
}

Result<ProcessedReadings> processed_readings(const MeasurementSet& set, const Group& group, const CurveSteps& steps) {
  ECS_TRY(curve, averaged(set, group));
  ECS_TRY(steps_done, processed(curve, steps));
  ProcessedReadings out{std::move(steps_done), set, std::move(curve), {}};
  out.before.readings.clear();
  for (const std::size_t i : group.readings) out.before.readings.push_back(set.readings[i]);
  out.after = out.before;
  for (Reading& reading : out.after.readings) reading.error -= value_at(out.level.removed, target_mm(reading));
  out.band_before = range_of(out.before);
  out.band = range_of(out.after);
  return out;
}

double band_of(const Curve& curve) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const CurvePoint& point : curve.points)
    for (const std::optional<double>& value : {point.forward, point.reverse}) {
      if (!value) continue;
      lowest = std::min(lowest, *value);
      highest = std::max(highest, *value);
    }
  return highest >= lowest ? highest - lowest : 0.0;
}

}  // namespace ecs::laser
