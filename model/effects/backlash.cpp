// Lost motion b·d/2: two levels, one for each approach (the reversal error of ISO 230-2).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition backlash() {
  return {
      .id = "backlash",
      .title = "Backlash",
      .formula = "b d/2",
      .cause = "lost motion in the drive",
      .tells_apart = "two levels, one per approach, whatever the position and the feed",
      .check =
          "place a dial gauge against the table and reverse by a few micrometres; check the preload of nut and "
          "bearings, coupling, keys and gibs",
      .headline = "lost motion of {um} at reversal in {where}",
      .parameters = {{"um", "um", "forward minus reverse"}},
      .carrier = Carrier::error_map,
      .how = "forward and reverse tables",
      .separated_by = separations::kAfterReversal,
      .traits = {.of_approach = true, .is_usual = true, .one_per_axis = true, .on_rotary_axes = true},
      .preference = 10,
      .columns = [](const ReadingAt& at,
                    std::span<double> row) { row[0] = at.approach() / 2.0 * reading_slope(at.data, at.k); },
      .of_reversal = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
