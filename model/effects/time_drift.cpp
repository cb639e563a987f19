// Creep of laser head or fixture, c·t (environmental variation of ISO 230-3).
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition time_drift() {
  return {
      .id = "time_drift",
      .title = "Drift in time",
      .formula = "c t",
      .cause = "laser head or fixture creeps",
      .tells_apart = "steady in time, whatever the position",
      .check =
          "keep the axis at rest and watch the laser for the length of a run; let its head warm up, shield the beam, "
          "tighten fixtures",
      .headline = "a drift of {um_per_h} in {where}, equal at every position",
      .parameters = {{"um_per_h", "um/h", "rate"}},
      .carrier = Carrier::set_up,
      .how = "an error of the measurement, not of the machine",
      .separated_by = separations::kFromCold,
      .traits = {.is_drift = true,
                 .shows_at_zero = true,
                 .of_measurement = true,
                 .from_origin = true,
                 .on_rotary_axes = true},
      .place = Place::sense,
      .needs = {Need::time},
      .preference = 100,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = at.data.since_origin_s(at.k) / 3600.0; },
      .of_sense = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
