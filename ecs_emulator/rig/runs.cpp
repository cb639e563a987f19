#include "ecs_emulator/rig/runs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace ecs::emulator {
namespace {

std::size_t steps_of(const RigPlan& plan) {
  return static_cast<std::size_t>(std::floor(std::abs(plan.to_mm - plan.from_mm) / plan.step_mm + 1e-9));
}

double target_of(const RigPlan& plan, std::size_t k) {
  return plan.from_mm + std::copysign(plan.step_mm, plan.to_mm - plan.from_mm) * static_cast<double>(k);
}

}  // namespace

laser::MeasurementSet calibrated(Rig& rig, const RigPlan& plan, bool compensated) {
  laser::MeasurementSet set;
  set.metadata = {{"machine", "single-axis test rig"}, {"runs", std::to_string(plan.runs)}};
  const double onward = plan.to_mm > plan.from_mm ? 1.0 : -1.0;
  const std::size_t last = steps_of(plan);
  const auto read = [&](std::size_t k, double sign, int run) {
    laser::Reading reading;
    reading.position_mm[0] = target_of(plan, k);
    rig.move_to(reading.position_mm[0], plan.feed_mm_min, plan.dwell_s);
    reading.error = rig.reading_um(reading.position_mm[0]);
    reading.approach = sign > 0.0 ? Approach::forward : Approach::reverse;
    reading.run = run;
    reading.compensated = compensated;
    reading.time_s = rig.drive().time_s();
    set.readings.push_back(reading);
  };
  for (int run = 1; run <= plan.runs; ++run) {
    rig.move_to(plan.from_mm - onward * plan.overrun_mm, plan.feed_mm_min, plan.dwell_s);
    for (std::size_t k = 0; k <= last; ++k) read(k, onward, run);
    rig.move_to(target_of(plan, last) + onward * plan.overrun_mm, plan.feed_mm_min, plan.dwell_s);
    for (std::size_t k = last + 1; k-- > 0;) read(k, -onward, run);
  }
  return set;
}

RigBand band_of(const laser::MeasurementSet& set) {
  std::map<std::pair<int, double>, std::vector<double>> groups;
  for (const laser::Reading& r : set.readings)
    groups[{static_cast<int>(r.approach), r.position_mm[0]}].push_back(r.error);
  RigBand band;
  double top = -1e300, bottom = 1e300;
  for (const auto& [place, errors] : groups) {
    RigTarget target{place.second, static_cast<Approach>(place.first), 0.0, 0.0};
    const auto n = static_cast<double>(errors.size());
    for (const double e : errors) target.mean_um += e / n;
    double squares = 0.0;
    for (const double e : errors) squares += (e - target.mean_um) * (e - target.mean_um);
    target.sigma_um = n > 1.0 ? std::sqrt(squares / (n - 1.0)) : 0.0;
    top = std::max(top, target.mean_um + 3.0 * target.sigma_um);
    bottom = std::min(bottom, target.mean_um - 3.0 * target.sigma_um);
    band.non_repeatability_um = std::max(band.non_repeatability_um, 6.0 * target.sigma_um);
    for (const double e : errors) band.largest_reading_um = std::max(band.largest_reading_um, std::abs(e));
    band.targets.push_back(target);
  }
  band.error_band_um = band.targets.empty() ? 0.0 : top - bottom;
  return band;
}

RigTables tables_of(const RigBand& band, const RigPlan& plan) {
  RigTables tables;
  const std::size_t last = steps_of(plan);
  tables.increment_mm = plan.step_mm;
  tables.start_mm = std::min(target_of(plan, 0), target_of(plan, last));
  tables.forward_um.assign(last + 1, 0.0);
  tables.reverse_um.assign(last + 1, 0.0);
  for (const RigTarget& target : band.targets) {
    auto& side = target.approach == Approach::forward ? tables.forward_um : tables.reverse_um;
    side[static_cast<std::size_t>(std::lround((target.position_mm - tables.start_mm) / plan.step_mm))] =
        -target.mean_um;
  }
  return tables;
}

}  // namespace ecs::emulator
