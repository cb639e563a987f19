// Friction that a drive has to overcome where its axis turns round, read on the fly: the slide stands while the drive
// builds up the force, then catches up (reversal pip; Armstrong-Hélouvry et al. 1994, Automatica 30, 1083). While it
// stands it falls behind with the square of the time, e = (t/t0)^2, for it should turn round at constant acceleration.
// From t0 on its speed changes steadily, so e goes on at the slope 2/t0 while the loop of the drive settles like a
// critically damped system of second order: (1 + (1/T + 2/t0) s) exp(-s/T), s = t - t0, largest at s = T - 1/(1/T +
// 2/t0). Lost motion of the axis changes sides when it moves, at t0: until then readings have that of before, -b d/2
// and not b d/2, so -b d more than `backlash` says. The b is that of `backlash`; an effect has no coefficient of
// another, so it is a column of its own.
#include <algorithm>
#include <cmath>
#include <limits>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::model::effects {
namespace {

constexpr double kMs_per_s = 1000.0;
/// Settling time of a position loop of 30 /s [s], which is usual; of one of twice and of half that speed. The second
/// column turns the first into any between: of loops of 15 to 40 /s less than 3 % of the squares is left; of 60 /s 2 to
/// 14 %, most where the axis stands for the shortest time.
constexpr double kSettling_s = 0.025, kFaster_s = 0.5 * kSettling_s, kSlower_s = 2.0 * kSettling_s;
/// The force grows with the way that the axis is behind, so that it lets go after a time as a^(-1/2), a the
/// acceleration at the reversal. The integral part of the regulator makes that less, the torque that slows the axis
/// down more: drives of 0.025 to 2 Nm between 0.7 and 44 mm/s^2 have -0.42 to -0.72, and the way that they stay behind
/// at most grows as a^0.01 to a^0.19. Sizes and times are those at this acceleration [mm/s^2], of 100 mm at 2000 mm/min
/// about.
constexpr double kAcceleration = 10.0, kTimeByAcceleration = -0.5, kSizeByAcceleration = 1.0 / 12.0;
/// Times of standing: no drive lets go within 5 ms; over 1 s it is another fault. From a third of the shortest time at
/// which a reading was taken (below, no reading shows it) to half of the longest (beyond, none shows that it ends);
/// about five of the sixteen are different trials.
constexpr double kShortest_ms = 5.0, kLongest_ms = 1000.0, kShortestOfStanding = 1.0 / 3.0, kLongestOfStanding = 0.5;
constexpr double kTrialsOfStanding = 5.0;
constexpr std::size_t kStandings = 16;
/// Assumed for planning [ms]: what a drive of usual size stands on a circle of usual feed.
constexpr double kAssumed_ms = 60.0;

/// The column, or an empty one.
const Column& since_reversal_s(const Observations& data) {
  static const Column none;
  const auto found = data.extras.find(kTimeSinceReversalColumn);
  return found == data.extras.end() ? none : found->second;
}

/// The acceleration at the reversal before a row, of kAcceleration; 1 where the travel is not known.
double acceleration_at(const Observations& data, std::size_t k) {
  const double since_s = since_reversal_s(data)[k], travel_mm = cell(data.travel_since_reversal_mm, k);
  return since_s > 0.0 && travel_mm > 0.0 ? 2.0 * travel_mm / (since_s * since_s) / kAcceleration : 1.0;
}

/// Since the reversal, at any acceleration as long as at kAcceleration [ms].
double comparable_ms(const Observations& data, std::size_t k) {
  return kMs_per_s * since_reversal_s(data)[k] * std::pow(acceleration_at(data, k), -kTimeByAcceleration);
}

ValueRange standing_limits(const Observations& data, const EffectInstance&, const Acting& acting, double) {
  double shortest = std::numeric_limits<double>::max(), longest = 0.0;
  for (const std::size_t k : acting.rows) {
    const double since_ms = comparable_ms(data, k);
    if (since_ms > 0.0) shortest = std::min(shortest, since_ms);
    longest = std::max(longest, since_ms);
  }
  const double least = std::clamp(kShortestOfStanding * shortest, kShortest_ms, 0.5 * kLongest_ms);
  return {least, std::clamp(kLongestOfStanding * longest, 2.0 * least, kLongest_ms)};
}

TriedValues standing_times(const Observations& data, const EffectInstance& effect, const Acting& acting,
                           const SearchExtent&) {
  TriedValues tried{.values = {0.0}};
  if (acting.rows.empty()) return tried;
  const auto [least, greatest] = standing_limits(data, effect, acting, 0.0);
  tried.values = logarithmic(least, greatest, kStandings);
  tried.independent = kTrialsOfStanding;
  return tried;
}

double assumed_standing(const Observations&, const EffectInstance&, const Acting&) { return kAssumed_ms; }

/// How far it is behind, of what it is where it lets go. @param free_s  since then  @param stands_s  until then
double settled(double free_s, double stands_s, double settling_s) {
  return (1.0 + (1.0 / settling_s + 2.0 / stands_s) * free_s) * std::exp(-free_s / settling_s);
}

/// How far it is behind at most, likewise.
double most_behind(double stands_s) {
  return settled(kSettling_s - 1.0 / (1.0 / kSettling_s + 2.0 / stands_s), stands_s, kSettling_s);
}

}  // namespace

EffectDefinition friction() {
  return {
      .id = "friction",
      .title = "Friction at reversal",
      .formula = "-c d (t/t0)^2 - b d from a reversal to t = t0, then the error settles",
      .cause = "friction that the drive must overcome before the axis reverses",
      .tells_apart = "in readings on the fly, grows for a moment after each reversal, then settles; absent at rest",
      .check =
          "watch the current of the drive as the axis creeps through a reversal: its step is twice the friction; check "
          "lubrication, wipers, gibs and the friction compensation of the control",
      .headline =
          "friction by which {readings}, read on the fly, stay {c_um} behind after each reversal for {stands_ms}",
      .parameters = {{"c_um", "um", "largest lag at 10 mm/s^2; below 0: friction is overcompensated"},
                     {"slower_um", "um", "part of the lag that settles slowly"},
                     {"late_um", "um", "lost motion that appears when the axis moves, as for backlash"},
                     {"stands_ms", "ms", "standstill time after a reversal at 10 mm/s^2", Coding::searched}},
      .carrier = Carrier::none,
      .how = "the unit does not know the force; friction compensation of the control",
      .separated_by = {45, "Repeat the circle with readings three times as close, at the same and at twice the feed."},
      .traits = {.of_approach = true, .in_motion = true},
      .needs = {Need::time_since_reversal},
      .preference = 51,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const double since_s = since_reversal_s(at.data)[at.k];
            const double part = comparable_ms(at.data, at.k) / at.searched;
            row[0] = row[1] = row[2] = 0.0;
            if (!(part > 0.0)) {  // at the reversal itself it stands, as far as it should
              row[2] = -at.approach();
              return;
            }
            const double stands_s = since_s / part, free_s = since_s - stands_s;
            const double size =
                -at.approach() * std::pow(acceleration_at(at.data, at.k), kSizeByAcceleration) / most_behind(stands_s);
            if (part < 1.0) {
              row[0] = size * part * part;
              row[2] = -at.approach();
              return;
            }
            row[0] = size * settled(free_s, stands_s, kSettling_s);
            row[1] = size * (settled(free_s, stands_s, kSlower_s) - settled(free_s, stands_s, kFaster_s));
          },
      .column_sets = {{0}, {0, 1}, {0, 2}, {0, 1, 2}},
      .search = {.tried = standing_times, .assumed = assumed_standing, .limits = standing_limits},
      .of_reversal = [](const Site& site) { return site.once(site.is_positioning()); },
  };
}

}  // namespace ecs::model::effects
