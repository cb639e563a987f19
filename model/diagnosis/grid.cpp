// At which values a nonlinear parameter is tried. Periods: even in frequency, oversampled, up to the Nyquist frequency
// of the targets (Lomb 1976; Scargle 1982; VanderPlas 2018, 7; for uneven targets Eyer and Bartholdi 1999), beside
// those that the machine's facts suggest; the common step of targets by Euclid's algorithm; times and lengths
// logarithmically.
#include <algorithm>
#include <array>
#include <cmath>

#include "model/diagnosis/search.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using enum EffectId;

/// Positions closer than this [mm] are one target: targets differ by more, and rounding of arithmetic is far below.
constexpr double kSameTarget_mm = 1e-5;
/// Euclid's algorithm ends at this share of the least step: what is left is rounding of the file.
constexpr double kRestOfStep = 1e-3;
/// Least common step, in mean distances of targets: below it the targets have none in practice.
constexpr double kLeastStep = 0.02;
/// Targets from which a period is looked for: a wave has three parameters, the model at least an offset and a slope.
constexpr std::size_t kFewestTargets = 6;
/// Highest frequency, in turns between two targets: uneven targets see more than half a turn; a choice.
constexpr double kHighestTurns = 5.0;
/// Fewer turns over the travel are a curve, not a period.
constexpr double kFewestTurns = 1.5;
/// Frequencies tried per 1/travel: three keep the nearest within a sixth of a turn over the travel (VanderPlas 2018:
/// five to ten; here the best are refined).
constexpr double kOversampling = 3.0;
/// Rounding of the highest frequency.
constexpr double kRounding = 1.0001;
/// Parts and multiples of a pitch: gears, belts, poles of a motor and starts of a thread, in the order of trust.
constexpr std::array kPartsOfPitch{1.0, 0.5, 2.0, 1.0 / 3.0, 0.25, 0.2, 3.0, 4.0, 5.0, 0.1};
/// Positions of a step tried at most: a choice of processor time.
constexpr std::size_t kMostSteps = 200;
/// Shifts of a map: half an increment each, no finer than so many over its range, up to a quarter of the range; below
/// half an increment by a factor, from this part of the range on.
constexpr double kMostShifts = 240.0, kLargestShift = 0.25, kFinestShifts = 2000.0, kShiftFactor = 1.3;
/// Time constants of warming up: a twentieth to one and a half of the time measured (beyond, an exponential is an
/// offset or a line); ten of them, a factor of 1.5 apart, about four of which are different trials.
constexpr double kShortestTimes = 20.0, kLongestOfTime = 1.5, kTrialsOfTime = 4.0;
constexpr std::size_t kTimes = 10;
/// Lengths of a reversal spike: from a third of the shortest travel since a reversal (a thousandth of the longest at
/// least) to one and a half of the longest; about five of the sixteen are different trials.
constexpr double kShortestOfTravel = 0.3, kLeastOfLongest = 1e-3, kLongestOfTravel = 1.5, kTrialsOfTravel = 5.0;
constexpr std::size_t kLengths = 16;

std::vector<double> logarithmic(double least, double greatest, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(least * std::pow(greatest / least, static_cast<double>(i) / static_cast<double>(count - 1)));
  return values;
}

std::vector<double> positions(const Observations& data, const Acting& acting, Axis axis) {
  std::vector<double> p;
  for (const std::size_t k : acting.rows) p.push_back(data.p_mm(k, axis));
  return distinct(std::move(p), kSameTarget_mm);
}

/// Greatest step of which all positions are multiples, 0 if it is below `least`.
double common_step(const std::vector<double>& p, double least) {
  double step = 0.0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    double a = std::max(step, p[i] - p[i - 1]), b = std::min(step, p[i] - p[i - 1]);
    while (b > kRestOfStep * least) {
      const double rest = std::abs(a - b * std::round(a / b));
      a = b;
      b = rest;
    }
    step = a;
    if (step < least) return 0.0;
  }
  return step;
}

Grid periods(const Observations& data, const Acting& acting, Axis axis, std::size_t most) {
  Grid grid;
  const std::vector<double> p = positions(data, acting, axis);
  if (p.size() < kFewestTargets) return grid;
  const double travel = p.back() - p.front();
  const double mean_step = travel / static_cast<double>(p.size() - 1);
  const double step = common_step(p, kLeastStep * mean_step);
  double highest = step > 0.0 ? 0.5 / step : kHighestTurns / mean_step;
  highest = std::min(highest, kHighestTurns / mean_step);
  const double lowest = kFewestTurns / travel;
  const auto wanted = static_cast<std::size_t>(std::max(1.0, kOversampling * travel * (highest - lowest)));
  const std::size_t count = std::min(wanted, most);
  for (std::size_t i = 0; i <= count; ++i) {
    const double frequency = lowest + static_cast<double>(i) / (kOversampling * travel);
    if (step > 0.0 && frequency > highest * kRounding) break;
    grid.values.push_back(1.0 / frequency);
  }
  grid.independent = std::max(2.0, static_cast<double>(grid.values.size()) / kOversampling);
  const auto& machine_axis = data.machine.axes[index_of(axis)];
  if (machine_axis) {
    for (const auto& pitch : {machine_axis->screw_pitch_mm, machine_axis->scale_pitch_mm}) {
      if (!pitch) continue;
      for (const double part : kPartsOfPitch)
        if (*pitch * part * kFewestTurns < travel) grid.facts.push_back(*pitch * part);
    }
  }
  return grid;
}

Grid steps(const Observations& data, const Acting& acting, Axis axis, std::size_t most) {
  Grid grid;
  const std::vector<double> p = positions(data, acting, axis);
  const std::size_t stride = std::max<std::size_t>(1, p.size() / most);
  for (std::size_t i = stride; i < p.size(); i += stride) grid.values.push_back(0.5 * (p[i] + p[i - 1]));
  grid.independent = static_cast<double>(p.size());
  return grid;
}

Grid shifts(const Observations& data, const EffectInstance& effect) {
  Grid grid;
  double widest = 0.0, increment = kBeyondAll;
  for (const laser::MapTable& table : data.map->tables) {
    if (effect.axis && moving_axis(table.component) != *effect.axis) continue;
    if (table.position_mm.size() < 2) continue;
    widest = std::max(widest, table.position_mm.back() - table.position_mm.front());
    increment = std::min(increment, (table.position_mm.back() - table.position_mm.front()) /
                                        static_cast<double>(table.position_mm.size() - 1));
  }
  if (widest <= 0.0) return grid;
  const auto add = [&](double shift) {
    grid.values.push_back(shift);
    grid.values.push_back(-shift);
  };
  // its size is not fitted: a small shift tried twice too large looks worse than none
  const double step = std::max(0.5 * increment, widest / kMostShifts);
  for (double shift = widest / kFinestShifts; shift < step; shift *= kShiftFactor) add(shift);
  for (double shift = step; shift <= kLargestShift * widest; shift += step) add(shift);
  grid.independent = static_cast<double>(grid.values.size()) / 2.0;
  return grid;
}

}  // namespace

Grid grid_of(const Regressors& regressors, const EffectInstance& effect, const Acting& acting,
             std::size_t most_values) {
  const Observations& data = regressors.data();
  Grid grid;
  if (const auto held = effect.parameters.find(std::string(nonlinear_parameter_of(effect.id)));
      held != effect.parameters.end()) {
    grid.values = {held->second};
    return grid;
  }
  if (effect.id == cyclic) return periods(data, acting, *effect.axis, most_values);
  if (effect.id == step) return steps(data, acting, *effect.axis, kMostSteps);
  if (effect.id == map_shift) return shifts(data, effect);
  const auto extent = [&](const Column& column) {
    double least = kBeyondAll, greatest = 0.0;
    for (const std::size_t k : acting.rows) {
      greatest = std::max(greatest, column[k]);
      if (column[k] > 0.0) least = std::min(least, column[k]);
    }
    return std::pair{std::min(least, greatest), greatest};
  };
  if (effect.id == warm_up && !acting.rows.empty()) {
    const double last = extent(data.time_s).second;
    if (last > 0.0) grid.values = logarithmic(last / kShortestTimes, kLongestOfTime * last, kTimes);
    grid.independent = kTrialsOfTime;
    return grid;
  }
  if (effect.id == reversal_spike && !acting.rows.empty()) {
    const auto [least, greatest] = extent(data.travel_since_reversal_mm);
    if (greatest > 0.0)
      grid.values = logarithmic(std::max(kShortestOfTravel * least, kLeastOfLongest * greatest),
                                kLongestOfTravel * greatest, kLengths);
    grid.independent = kTrialsOfTravel;
    return grid;
  }
  grid.values = {0.0};
  return grid;
}

}  // namespace ecs::model
