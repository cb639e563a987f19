// Friction that a drive has to overcome where its axis turns round, read on the fly: the slide stands while the drive
// builds up the force, then catches up (reversal pip; Armstrong-Hélouvry et al. 1994, Automatica 30, 1083). While it
// stands the axis it should have left falls behind with the square of the time, for it turns round at constant
// acceleration; the loop of the drive then settles as at the aperiodic limit, (1 + t/T) exp(-t/T).
#include <algorithm>
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/effects/tried_values.hpp"

namespace ecs::model::effects {
namespace {

constexpr double kMs_per_s = 1000.0;
/// Settling time of a position loop of 30 /s [s], which is usual; of one of twice and of half that speed. The second
/// column turns the first into any between: of loops of 15 to 60 /s less than 3 % of the squares is left.
constexpr double kSettling_s = 0.025, kFaster_s = 0.5 * kSettling_s, kSlower_s = 2.0 * kSettling_s;
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

ValueRange standing_limits(const Observations& data, const EffectInstance&, const Acting& acting, double) {
  const auto [least_s, greatest_s] = extent_of(since_reversal_s(data), acting);
  const double least = std::clamp(kShortestOfStanding * least_s * kMs_per_s, kShortest_ms, 0.5 * kLongest_ms);
  return {least, std::clamp(kLongestOfStanding * greatest_s * kMs_per_s, 2.0 * least, kLongest_ms)};
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

double settled(double since_s, double settling_s) {
  return (1.0 + since_s / settling_s) * std::exp(-since_s / settling_s);
}

}  // namespace

EffectDefinition friction() {
  return {
      .id = "friction",
      .title = "Friction at reversal",
      .formula = "-c d (t/t0)^2, settling from t0; t since reversal",
      .cause = "friction that the drive has to overcome before the axis turns round",
      .tells_apart = "read on the fly, grows for a moment after each reversal, then settles; at rest it is gone",
      .check =
          "watch the current of the drive as the axis creeps through a reversal: twice the friction is its step; look "
          "at "
          "lubrication, wipers, gibs and the friction compensation of the control",
      .headline =
          "{where}, read on the fly, staying {c_um} behind after each reversal for {stands_ms} until friction is "
          "overcome",
      .parameters = {{"c_um", "um", "how far it stays behind; below 0: friction is compensated too much"},
                     {"slower_um", "um", "part of it that settles slowly rather than fast"},
                     {"stands_ms", "ms", "time that it stands after a reversal", Coding::searched}},
      .carrier = Carrier::none,
      .how = "the unit does not know the force; friction compensation of the control",
      .separated_by = {45, "Repeat the circle with readings three times as close, at the same and at twice the feed."},
      .traits = {.of_approach = true, .in_motion = true},
      .needs = {Need::time_since_reversal},
      .preference = 51,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const double stands_s = at.searched / kMs_per_s;
            const double since_s = since_reversal_s(at.data)[at.k], free_s = since_s - stands_s;
            const double part = since_s / stands_s;
            row[0] = -at.approach() * (free_s < 0.0 ? part * part : settled(free_s, kSettling_s));
            row[1] = free_s < 0.0 ? 0.0 : -at.approach() * (settled(free_s, kSlower_s) - settled(free_s, kFaster_s));
          },
      .column_sets = {{0}, {0, 1}},
      .search = {.tried = standing_times, .assumed = assumed_standing, .limits = standing_limits},
      .of_reversal = [](const Site& site) { return site.once(site.is_positioning()); },
  };
}

}  // namespace ecs::model::effects
