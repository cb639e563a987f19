#include "devices/capture_plan.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/moved_targets.hpp"

namespace ecs::devices {
namespace {

constexpr double kMostStops = 1'000'000;

std::vector<double> targets_of(const CaptureLine& line) {
  const double way = std::abs(line.to_mm - line.from_mm);
  const double step = std::abs(line.step_mm);
  const double sign = line.to_mm < line.from_mm ? -1.0 : 1.0;
  std::vector<double> targets;
  const auto whole = static_cast<long>(std::floor(way / step + 1e-9));
  for (long k = 0; k <= whole; ++k) targets.push_back(line.from_mm + sign * step * static_cast<double>(k));
  if (way - step * static_cast<double>(whole) > step * 1e-6) targets.push_back(line.to_mm);
  return line.moved ? moved_targets(std::move(targets)) : targets;
}

}  // namespace

Result<std::vector<laser::Reading>> stops_of(const CaptureLine& line) {
  const double step = std::abs(line.step_mm);
  if (line.from_mm == line.to_mm || step == 0.0)
    return problem(ProblemKind::usage, "expected two different ends (--from, --to) and a --step other than 0");
  if (std::abs(line.to_mm - line.from_mm) / step * line.runs * 2.0 > kMostStops)
    return problem(ProblemKind::usage, fmt::format("a step of {} mm makes more than a million readings", step));
  std::vector<double> targets = targets_of(line);
  const bool rising = line.to_mm > line.from_mm;
  std::vector<laser::Reading> stops;
  for (int run = 1; run <= line.runs; ++run)
    for (int pass = 0; pass < (line.one_way ? 1 : 2); ++pass) {
      laser::Reading stop;
      stop.axis = line.axis;
      stop.sense = line.sense;
      stop.position_mm = line.parked_mm;
      stop.run = run;
      stop.feed_mm_min = line.feed_mm_min;
      stop.approach = rising == (pass == 0) ? Approach::forward : Approach::reverse;
      for (std::size_t k = 0; k < targets.size(); ++k) {
        stop.position_mm[index_of(line.axis)] = targets[pass == 0 ? k : targets.size() - 1 - k];
        stops.push_back(stop);
      }
    }
  return stops;
}

Result<std::vector<laser::Reading>> stops_of_targets(const laser::MeasurementSet& targets) {
  std::vector<laser::Reading> stops = targets.readings;
  for (laser::Reading& stop : stops) {
    if (stop.approach == Approach::unknown)
      return problem_at(targets.source, stop.line, 0,
                        "approach: expected 1 or -1: from which side the target is to be approached");
    stop.error = 0.0;
    stop.time_s.reset();
    stop.row = stop.line = 0;
  }
  return stops;
}

bool same_pass(const laser::Reading& a, const laser::Reading& b) {
  return a.axis == b.axis && a.sense == b.sense && a.run == b.run && a.approach == b.approach;
}

}  // namespace ecs::devices
