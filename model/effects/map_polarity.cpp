// The map applied with the wrong sign: −2 × its compensation.
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition map_polarity() {
  return {
      .id = "map_polarity",
      .title = "Compensation applied with the wrong sign",
      .formula = "-2 x map",
      .cause = "polarity of the output or sign convention of a component",
      .tells_apart = "minus twice the uploaded map",
      .check = "command a known correction on the output screen and check in which direction the axis moves",
      .headline = "the {map} applied with the wrong sign",
      .parameters = {{"fraction", "", "1 = all of it", Coding::fixed}},
      .carrier = Carrier::parameters,
      .how = "compensation polarity, or the sign of that component's table",
      .separated_by = separations::kCompensationOff,
      .traits = {.fixed_size = true},
      .place = Place::map,
      .preference = 10,
      .fixed_part = [](const ReadingAt& at) { return -2.0 * map_compensation(at); },
  };
}

}  // namespace ecs::model::effects
