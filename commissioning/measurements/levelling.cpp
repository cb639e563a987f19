#include "commissioning/measurements/levelling.hpp"

#include <algorithm>

#include "commissioning/measurements/files.hpp"

namespace ecs::app {
namespace {

double range_of(const laser::MeasurementSet& set) {
  const auto [least, most] =
      std::minmax_element(set.readings.begin(), set.readings.end(),
                          [](const laser::Reading& a, const laser::Reading& b) { return a.error < b.error; });
  return most->error - least->error;
}

}  // namespace

Result<LevelledReadings> levelled_readings(const laser::MeasurementSet& set, const laser::Group& group,
                                           laser::SlopeMethod method) {
  LevelledReadings out;
  auto curve = laser::averaged(set, group);
  if (!curve) return tl::unexpected(curve.error());
  auto level = laser::levelled(*curve, method);
  if (!level) return tl::unexpected(level.error());
  out.before = set_of(set, group);
  out.before_curve = std::move(*curve);
  out.after = out.before;
  for (laser::Reading& reading : out.after.readings)
    reading.error -= laser::value_at(level->removed, laser::target_mm(reading));
  out.level = std::move(*level);
  out.band_before = range_of(out.before);
  out.band = range_of(out.after);
  return out;
}

}  // namespace ecs::app
