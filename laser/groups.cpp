#include "laser/groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace ecs::laser {
namespace {

constexpr double kShareOfStep = 0.01;
constexpr double kToleranceWithoutSteps_mm = 1e-3;

Vector3 parked_mm(const Reading& reading) {
  Vector3 position = reading.position_mm;
  if (!reading.rotary) position[index_of(reading.axis)] = 0.0;
  return position;
}

Vector3 parked_deg(const Reading& reading) {
  Vector3 position = reading.angle_deg;
  if (reading.rotary) position[index_of(reading.axis)] = 0.0;
  return position;
}

bool same_place(const Vector3& a, const Vector3& b) {
  for (std::size_t i = 0; i < kAxes; ++i)
    if (std::abs(a[i] - b[i]) > kSamePlace_mm) return false;
  return true;
}

bool belongs(const Reading& reading, const Group& group) {
  return reading.axis == group.axis && reading.rotary == group.rotary && reading.sense == group.sense &&
         reading.compensated == group.compensated && same_place(parked_mm(reading), group.parked_mm) &&
         same_place(parked_deg(reading), group.parked_deg);
}

}  // namespace

std::vector<Group> groups_of(const MeasurementSet& set) {
  std::vector<Group> groups;
  std::size_t latest = 0;  // neighbours in a file mostly belong together
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    const Reading& reading = set.readings[i];
    if (groups.empty() || !belongs(reading, groups[latest])) {
      const auto found = std::ranges::find_if(groups, [&](const Group& group) { return belongs(reading, group); });
      latest = static_cast<std::size_t>(found - groups.begin());
      if (found == groups.end())
        groups.push_back({reading.axis,
                          reading.sense,
                          parked_mm(reading),
                          reading.compensated,
                          {},
                          reading.rotary,
                          parked_deg(reading)});
    }
    groups[latest].readings.push_back(i);
  }
  return groups;
}

double target_tolerance_mm(const MeasurementSet& set, const Group& group) {
  std::map<std::pair<int, Approach>, std::vector<double>> passes;
  for (const std::size_t i : group.readings)
    passes[{set.readings[i].run, set.readings[i].approach}].push_back(target_of(set.readings[i]));
  double smallest = std::numeric_limits<double>::infinity();
  for (auto& [pass, positions] : passes) {
    std::ranges::sort(positions);
    for (std::size_t i = 1; i < positions.size(); ++i) {
      const double step = positions[i] - positions[i - 1];
      if (step > kSamePlace_mm) smallest = std::min(smallest, step);
    }
  }
  return std::isfinite(smallest) ? kShareOfStep * smallest : kToleranceWithoutSteps_mm;
}

std::vector<TargetReadings> targets_of(const MeasurementSet& set, const Group& group, double tolerance_mm) {
  std::vector<std::size_t> order = group.readings;
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return target_of(set.readings[a]) < target_of(set.readings[b]); });
  std::vector<TargetReadings> targets;
  double first_mm = 0.0;
  double sum_mm = 0.0;
  std::size_t merged = 0;
  for (const std::size_t i : order) {
    const Reading& reading = set.readings[i];
    const double position_mm = target_of(reading);
    if (targets.empty() || position_mm - first_mm > tolerance_mm) {
      targets.push_back({position_mm, {}, {}, {}});
      first_mm = position_mm;
      sum_mm = 0.0;
      merged = 0;
    }
    TargetReadings& target = targets.back();
    sum_mm += position_mm - first_mm;
    target.position_mm = first_mm + sum_mm / static_cast<double>(++merged);
    auto& side = reading.approach == Approach::forward   ? target.forward
                 : reading.approach == Approach::reverse ? target.reverse
                                                         : target.undirected;
    side.push_back(reading.error);
  }
  return targets;
}

bool has_known_approach(const MeasurementSet& set, const Group& group) {
  return std::ranges::any_of(group.readings,
                             [&](std::size_t i) { return set.readings[i].approach != Approach::unknown; });
}

std::optional<double> mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<double> deviation_of(const std::vector<double>& values) {
  if (values.size() < 2) return std::nullopt;
  const double mean = *mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ecs::laser
