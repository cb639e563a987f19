#include "laser/analysis/pipeline.hpp"

#include <algorithm>
#include <limits>

namespace ecs::laser {
namespace {

double range_of(const MeasurementSet& set) {
  const auto [least, most] = std::minmax_element(set.readings.begin(), set.readings.end(),
                                                 [](const Reading& a, const Reading& b) { return a.error < b.error; });
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
