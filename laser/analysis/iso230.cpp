#include "laser/analysis/iso230.hpp"

#include <algorithm>
#include <cmath>

#include "laser/analysis/iso230_notes.hpp"

namespace ecs::laser {
namespace {

using Value = std::optional<double>;

Value larger(Value a, Value b) {
  if (!a || !b) return a ? a : b;
  return std::max(*a, *b);
}

Value absolute(Value a) { return a ? Value(std::abs(*a)) : a; }

/// Largest and smallest of what was taken in.
struct Extent {
  Value low;
  Value high;
  void take(Value mean, Value margin) {
    if (!mean || !margin) return;
    high = larger(high, *mean + *margin);
    const Value lower = *mean - *margin;
    low = low ? Value(std::min(*low, *lower)) : lower;
  }
  [[nodiscard]] Value range() const { return high ? Value(*high - *low) : Value{}; }
};

Value times(double factor, Value value) { return value ? Value(factor * *value) : value; }

Iso230Target target_of(const TargetReadings& readings, bool approach_known) {
  Iso230Target target;
  target.position_mm = readings.position_mm;
  target.n_forward = static_cast<int>(readings.forward.size());
  target.n_reverse = static_cast<int>(readings.reverse.size());
  target.mean_forward = mean_of(readings.forward);
  target.mean_reverse = mean_of(readings.reverse);
  target.s_forward = deviation_of(readings.forward);
  target.s_reverse = deviation_of(readings.reverse);
  target.R_forward = times(4.0, target.s_forward);
  target.R_reverse = times(4.0, target.s_reverse);
  if (target.mean_forward && target.mean_reverse) {
    target.mean = (*target.mean_forward + *target.mean_reverse) / 2.0;
    target.B = *target.mean_forward - *target.mean_reverse;
  }
  if (target.B && target.s_forward && target.s_reverse)
    target.R = std::max({2.0 * *target.s_forward + 2.0 * *target.s_reverse + std::abs(*target.B), *target.R_forward,
                         *target.R_reverse});
  if (!approach_known) {
    target.mean = mean_of(readings.undirected);
    target.s_undirected = deviation_of(readings.undirected);
  }
  return target;
}

/// Axis values that need means only.
void set_systematic(Iso230& axis) {
  Extent forward, reverse, both, means;
  double sum_B = 0.0;
  int count_B = 0;
  for (const Iso230Target& target : axis.targets) {
    forward.take(target.mean_forward, 0.0);
    reverse.take(target.mean_reverse, 0.0);
    means.take(target.mean, 0.0);
    both.take(target.mean_forward, 0.0);
    both.take(target.mean_reverse, 0.0);
    axis.B = larger(axis.B, absolute(target.B));
    if (target.B) {
      sum_B += *target.B;
      ++count_B;
    }
  }
  axis.E_forward = forward.range();
  axis.E_reverse = reverse.range();
  axis.M = means.range();
  if (axis.E_forward && axis.E_reverse) axis.E = both.range();
  if (count_B > 0) axis.B_mean = sum_B / count_B;
}

/// Axis values that need standard deviations.
void set_random(Iso230& axis) {
  Extent forward, reverse, both, band;
  for (const Iso230Target& target : axis.targets) {
    axis.R_forward = larger(axis.R_forward, target.R_forward);
    axis.R_reverse = larger(axis.R_reverse, target.R_reverse);
    axis.R = larger(axis.R, target.R);
    forward.take(target.mean_forward, times(2.0, target.s_forward));
    reverse.take(target.mean_reverse, times(2.0, target.s_reverse));
    both.take(target.mean_forward, times(2.0, target.s_forward));
    both.take(target.mean_reverse, times(2.0, target.s_reverse));
    band.take(target.mean_forward, times(3.0, target.s_forward));
    band.take(target.mean_reverse, times(3.0, target.s_reverse));
    band.take(target.mean, times(3.0, target.s_undirected));
    for (const Value s : {target.s_forward, target.s_reverse, target.s_undirected})
      axis.non_repeatability = larger(axis.non_repeatability, times(6.0, s));
  }
  axis.A_forward = forward.range();
  axis.A_reverse = reverse.range();
  if (axis.A_forward && axis.A_reverse) axis.A = both.range();
  axis.three_sigma_band = band.range();
}

}  // namespace

Result<Iso230> iso230_of(const MeasurementSet& set, const Group& group) {
  if (group.readings.empty()) return problem(ProblemKind::refused, "expected readings to evaluate, found none");
  Iso230 axis;
  axis.axis = group.axis;
  axis.rotary = group.rotary;
  axis.sense = group.sense;
  axis.parked_mm = group.parked_mm;
  axis.compensated = group.compensated;
  axis.merge_tolerance_mm = target_tolerance_mm(set, group);
  const bool known = has_known_approach(set, group);
  const auto targets = targets_of(set, group, axis.merge_tolerance_mm);
  for (const TargetReadings& readings : targets)
    if (!known || !readings.forward.empty() || !readings.reverse.empty())
      axis.targets.push_back(target_of(readings, known));
  set_systematic(axis);
  set_random(axis);
  Extent all;
  for (const std::size_t i : group.readings) all.take(set.readings[i].error, 0.0);
  axis.range = all.range().value_or(0.0);
  axis.notes = iso230_notes(set, group, axis);
  return axis;
}

Result<std::vector<Iso230>> iso230_of(const MeasurementSet& set) {
  std::vector<Iso230> all;
  for (const Group& group : groups_of(set)) {
    ECS_TRY(one, iso230_of(set, group));
    all.push_back(std::move(one));
  }
  if (all.empty()) return problem(ProblemKind::refused, "expected readings to evaluate, found none");
  return all;
}

}  // namespace ecs::laser
