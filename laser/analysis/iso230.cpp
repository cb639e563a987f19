// The conditions of ISO 230-2:2014 that a measurement does not meet, in words, and the evaluation.
#include "laser/analysis/iso230.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"

namespace ecs::laser {
namespace {

constexpr int kRuns = 5;                  ///< in each direction, axes up to 2000 mm
constexpr double kTargetsPerMetre = 5.0;  ///< and at least five
constexpr double kLongAxis_mm = 2000.0;
constexpr double kTurn_deg = 360.0;

/// [mm], of a rotary axis [deg].
double span_mm(const Iso230& axis) { return axis.targets.back().position_mm - axis.targets.front().position_mm; }

bool is_evenly_spaced(const Iso230& axis) {
  if (axis.targets.size() < 3) return false;
  const double step = span_mm(axis) / static_cast<double>(axis.targets.size() - 1);
  for (std::size_t i = 0; i < axis.targets.size(); ++i)
    if (std::abs(axis.targets[i].position_mm - axis.targets.front().position_mm - step * static_cast<double>(i)) >
        axis.merge_tolerance_mm)
      return false;
  return true;
}

/// Targets that the standard asks for of a rotary axis, by its travel [deg].
std::size_t rotary_targets(double travel_deg) {
  if (travel_deg <= 90.0) return 3;
  return travel_deg <= 180.0 ? 5 : 8;
}

/// Where 0 and 360 degrees were both measured, they are one place.
void note_closing(const Iso230& axis, std::vector<std::string>& notes) {
  const Iso230Target &first = axis.targets.front(), &last = axis.targets.back();
  const bool closes = std::abs(last.position_mm - first.position_mm - kTurn_deg) <= axis.merge_tolerance_mm;
  const auto mean = [](const Iso230Target& t) {
    return t.mean ? t.mean : t.mean_forward ? t.mean_forward : t.mean_reverse;
  };
  if (closes && mean(first) && mean(last))
    notes.push_back(fmt::format("the readings at {:g} and {:g} deg, the same position, differ by {:+.3g} um/m",
                                first.position_mm, last.position_mm, *mean(last) - *mean(first)));
}

constexpr const char* kPeriodHidden =
    "targets are equally spaced: a periodic error whose period divides their spacing is not visible";

void note_rotary_targets(const Iso230& axis, std::vector<std::string>& notes) {
  const std::size_t wanted = rotary_targets(span_mm(axis));
  if (axis.targets.size() < wanted)
    notes.push_back(fmt::format("{} targets on {:g} deg; ISO 230-2 requires at least {}", axis.targets.size(),
                                span_mm(axis), wanted));
  if (is_evenly_spaced(axis)) notes.emplace_back(kPeriodHidden);
  note_closing(axis, notes);
}

void note_targets(const Iso230& axis, std::vector<std::string>& notes) {
  if (axis.rotary) return note_rotary_targets(axis, notes);
  const std::size_t count = axis.targets.size();
  const double metres = span_mm(axis) / kMmPerM;
  if (count < 5) notes.push_back(fmt::format("{} targets; ISO 230-2 requires at least 5", count));
  if (metres > 0.0 && metres <= kLongAxis_mm / kMmPerM && static_cast<double>(count) < kTargetsPerMetre * metres)
    notes.push_back(fmt::format("{} targets on {:.3f} m; ISO 230-2 requires at least 5 per metre", count, metres));
  if (metres > kLongAxis_mm / kMmPerM)
    notes.push_back(
        "longer than 2000 mm: the standard requires targets about every 250 mm, and defines A and R for shorter axes "
        "only");
  if (is_evenly_spaced(axis)) notes.emplace_back(kPeriodHidden);
}

void note_runs(const Iso230& axis, std::vector<std::string>& notes) {
  const auto side = [&](const char* name, int Iso230Target::*count) {
    const auto [fewest, most] =
        std::ranges::minmax_element(axis.targets, [&](const auto& a, const auto& b) { return a.*count < b.*count; });
    const int low = (*fewest).*count;
    const int high = (*most).*count;
    if (high == 0) return false;
    if (low == high && low < kRuns)
      notes.push_back(fmt::format("{} {} reading{} at every target; ISO 230-2 requires {}{}", low, name,
                                  low == 1 ? "" : "s", kRuns,
                                  !axis.rotary && span_mm(axis) > kLongAxis_mm ? " on axes up to 2000 mm" : ""));
    else if (low < kRuns)
      notes.push_back(fmt::format("fewer than {} {} readings at {} (as few as {})", kRuns, name,
                                  high < kRuns ? "every target" : "some targets", low));
    if (low != high)
      notes.push_back(fmt::format("the number of {} readings differs between targets: {} to {}", name, low, high));
    return true;
  };
  const bool forward = side("forward", &Iso230Target::n_forward);
  const bool reverse = side("reverse", &Iso230Target::n_reverse);
  if (forward != reverse)
    notes.push_back(fmt::format("{} approach only: no bidirectional values", forward ? "forward" : "reverse"));
  if (!forward && !reverse)
    notes.emplace_back(
        "the approach is unknown: no unidirectional or bidirectional values. Give it in a column approach (1 forward, "
        "-1 "
        "reverse)");
}

void note_left_out(const Iso230& axis, std::vector<std::string>& notes) {
  const auto lacks = [&](auto mean, auto s) {
    return std::ranges::count_if(axis.targets,
                                 [&](const Iso230Target& target) { return target.*mean && !(target.*s); });
  };
  const auto single = lacks(&Iso230Target::mean_forward, &Iso230Target::s_forward) +
                      lacks(&Iso230Target::mean_reverse, &Iso230Target::s_reverse);
  const bool only_single = std::ranges::none_of(
      axis.targets, [](const Iso230Target& target) { return target.s_forward || target.s_reverse; });
  if (single > 0)
    notes.push_back(fmt::format("{} target{}{} {} only one reading and no standard deviation{}", single,
                                single == 1 ? "" : "s",
                                axis.E_forward && axis.E_reverse ? " (forward and reverse counted separately)" : "",
                                single == 1 ? "has" : "have",
                                only_single ? ", so A, R and the 3 sigma band cannot be computed"
                                            : ". R, A and the 3 sigma band are computed without them, so A can be "
                                              "smaller than E"));
  const auto one_sided = std::ranges::count_if(axis.targets, [](const Iso230Target& target) {
    return target.mean_forward.has_value() != target.mean_reverse.has_value();
  });
  if (axis.B && one_sided > 0)
    notes.push_back(fmt::format("targets with one approach only: {}. They are not used for B, M, R and P VDI{}",
                                one_sided, axis.M ? "" : ". M needs two targets with both approaches"));
}

/// One sentence for each condition that is not met (clause 5: targets, runs, approaches) and for readings left out.
std::vector<std::string> iso230_notes(const MeasurementSet& set, const Group& group, const Iso230& axis) {
  std::vector<std::string> notes;
  note_targets(axis, notes);
  note_runs(axis, notes);
  note_left_out(axis, notes);
  if (axis.sense != static_cast<Sense>(index_of(axis.axis) + (axis.rotary ? kAxes : 0)))
    notes.emplace_back(
        "not a positioning error: ISO 230-2 covers positioning only, and its formulas are applied by analogy");
  const auto undirected = std::ranges::count_if(
      group.readings, [&](std::size_t i) { return set.readings[i].approach == Approach::unknown; });
  if (undirected > 0 && has_known_approach(set, group))
    notes.push_back(fmt::format("{} reading{} of unknown approach {} ignored", undirected, undirected == 1 ? "" : "s",
                                undirected == 1 ? "is" : "are"));
  return notes;
}

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
  int count_B = 0, count_mean = 0;
  for (const Iso230Target& target : axis.targets) {
    forward.take(target.mean_forward, 0.0);
    reverse.take(target.mean_reverse, 0.0);
    means.take(target.mean, 0.0);
    count_mean += target.mean ? 1 : 0;
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
  if (count_mean > 1) axis.M = means.range();
  if (axis.E_forward && axis.E_reverse) axis.E = both.range();
  if (count_B > 0) axis.B_mean = sum_B / count_B;
}

/// Axis values that need standard deviations.
void set_random(Iso230& axis) {
  Extent forward, reverse, both, band, vdi;
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
    if (target.B && target.s_forward && target.s_reverse) {
      const double scatter = 6.0 * (*target.s_forward + *target.s_reverse) / 2.0;
      axis.vdi_Ps = larger(axis.vdi_Ps, scatter);
      vdi.take(target.mean, (std::abs(*target.B) + scatter) / 2.0);
    }
    for (const Value s : {target.s_forward, target.s_reverse, target.s_undirected})
      axis.non_repeatability = larger(axis.non_repeatability, times(6.0, s));
  }
  axis.A_forward = forward.range();
  axis.A_reverse = reverse.range();
  if (axis.A_forward && axis.A_reverse) axis.A = both.range();
  axis.three_sigma_band = band.range();
  axis.vdi_P = vdi.range();
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

}  // namespace ecs::laser
