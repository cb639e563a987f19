// Stick-slip and wind-up of a screw, c·d·exp(−u/u0), u the travel since the reversal.
#include <algorithm>
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {
namespace {

/// Lengths: from a third of the shortest travel since a reversal (a thousandth of the longest at least; below, nothing
/// is left at the first reading) to half of the longest (beyond, it does not decay: a backlash); about five of the
/// sixteen are different trials.
constexpr double kShortestOfTravel = 1.0 / 3.0, kLeastOfLongest = 1e-3, kLongestOfTravel = 0.5, kTrialsOfTravel = 5.0;
constexpr std::size_t kLengths = 16;
/// Assumed for planning: a fifth of the longest travel, no less than this [mm]; well inside what a plan can show.
constexpr double kLengthsAssumed = 5.0, kLeastLength_mm = 1e-3;

ValueRange decay_length_limits(const Observations& data, const EffectInstance&, const Acting& acting, double) {
  const auto [least, greatest] = extent_of(data.travel_since_reversal_mm, acting);
  return {std::max(kShortestOfTravel * least, kLeastOfLongest * greatest), kLongestOfTravel * greatest};
}

TriedValues decay_lengths(const Observations& data, const EffectInstance& effect, const Acting& acting,
                          const SearchExtent&) {
  TriedValues tried{.values = {0.0}};
  if (acting.rows.empty()) return tried;
  tried.values.clear();
  const auto [least, greatest] = decay_length_limits(data, effect, acting, 0.0);
  if (greatest > 0.0) tried.values = logarithmic(least, greatest, kLengths);
  tried.independent = kTrialsOfTravel;
  return tried;
}

double assumed_decay_length(const Observations& plan, const EffectInstance&, const Acting& acting) {
  double longest_mm = 0.0;
  for (const std::size_t k : acting.rows) longest_mm = std::max(longest_mm, plan.travel_since_reversal_mm[k]);
  return std::max(longest_mm / kLengthsAssumed, kLeastLength_mm);
}

}  // namespace

EffectDefinition reversal_spike() {
  return {
      .id = "reversal_spike",
      .title = "Reversal spike",
      .formula = "c d exp(-u/u0), u = travel since reversal",
      .cause = "stick-slip, wind-up of the screw",
      .tells_apart = "decays with the travel since the last reversal",
      .check =
          "creep through a reversal with a dial gauge and watch for a jump; check lubrication, wipers, gibs and screw "
          "bearings",
      .headline = "a spike of {c_um} after each reversal in {where}, with a decay length of {u0_mm}",
      .parameters = {{"c_um", "um", "size at the reversal"},
                     {"u0_mm", "mm", "travel over which it decays", Coding::searched}},
      .carrier = Carrier::none,
      .how = "the map has no entry for the travel since a reversal",
      .separated_by = separations::kAfterReversal,
      .turns_into = {{Limit::at_greatest, "backlash"}},
      .traits = {.of_approach = true},
      .needs = {Need::travel_since_reversal},
      .preference = 50,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            row[0] = at.approach() * std::exp(-at.data.travel_since_reversal_mm[at.k] / at.searched);
          },
      .search = {.tried = decay_lengths, .assumed = assumed_decay_length, .limits = decay_length_limits},
      .of_reversal = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
