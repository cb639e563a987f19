// A shift c of all readings of a sense: datum or laser zero.
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition offset() {
  return {
      .id = "offset",
      .title = "Datum shift",
      .formula = "c",
      .cause = "datum or laser zero shifted",
      .tells_apart = "the same everywhere and always",
      .check = "check where the readout was set to zero, and the repeatability of the datum switch",
      .headline = "{where} all shifted by {um}",
      .parameters = {{"um", "um", "constant offset"}},
      .carrier = Carrier::error_map,
      .how = "a constant in the map, or the null offset of the datum (null_offset_mm)",
      .separated_by = separations::kFinerTargets,
      .traits = {.shows_at_zero = true, .is_usual = true, .one_per_axis = true, .on_rotary_axes = true},
      .place = Place::sense,
      .preference = 0,
      .columns = [](const ReadingAt&, std::span<double> row) { row[0] = 1.0; },
      .of_sense = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
