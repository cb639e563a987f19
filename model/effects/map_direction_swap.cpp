// Forward and reverse tables exchanged: map(p, −d) − map(p, d).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition map_direction_swap() {
  return {
      .id = "map_direction_swap",
      .title = "Forward and reverse tables exchanged",
      .formula = "map(p, -d) - map(p, d)",
      .cause = "approach sensed with the wrong sign",
      .tells_apart = "the map's own reversal, twice and with opposite sign",
      .check =
          "jog the axis both ways and see on the monitor which table is in use; compare with the direction set for the "
          "unit",
      .headline = "the {map} applied with forward and reverse tables exchanged",
      .carrier = Carrier::parameters,
      .how = "a setting of the unit: correct it and measure again",
      .separated_by = separations::kCompensationOff,
      .traits = {.fixed_size = true, .of_approach = true},
      .place = Place::map,
      .preference = 40,
      .fixed_part =
          [](const ReadingAt& at) {
            return map_compensation(at.data, at.k, at.effect, 0.0, -at.data.approach[at.k]) - map_compensation(at);
          },
  };
}

}  // namespace ecs::model::effects
