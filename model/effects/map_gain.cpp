// The output scaled by g instead of 1: (g − 1) × the map's compensation.
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition map_gain() {
  return {
      .id = "map_gain",
      .title = "Output scaling wrong",
      .formula = "(g - 1) x map",
      .cause = "D/A scaling or unit of the map wrong",
      .tells_apart = "in proportion to the uploaded map",
      .check = "command a known correction on the output screen and read the motion with a dial gauge or the laser",
      .headline = "the {map} applied {gain} times its size",
      .parameters = {{.name = "gain", .unit = "", .meaning = "1 = right", .neutral = 1.0}},
      .carrier = Carrier::parameters,
      .how = "the output scale",
      .separated_by = separations::kCompensationOff,
      .place = Place::map,
      .preference = 20,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = map_compensation(at); },
  };
}

}  // namespace ecs::model::effects
