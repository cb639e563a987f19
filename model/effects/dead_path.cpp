// Uncompensated path between the optics at reset, L·Δn (Steinmetz 1990).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition dead_path() {
  return {
      .id = "dead_path",
      .title = "Dead path",
      .formula = "L_d dn",
      .cause = "uncompensated path between the optics at reset",
      .tells_apart = "follows the refractive index of air, the same at every position",
      .check =
          "measure the air between the two optics where the readout was set to zero, and check that the laser corrects "
          "it",
      .headline = "a dead path of {length_m} in air between the optics in {where}",
      .parameters =
          {{.name = "length_m", .unit = "m", .meaning = "length of the dead path", .limits = ValueRange{-10.0, 10.0}}},
      .carrier = Carrier::set_up,
      .how = "an error of the measurement: set the readout to zero with the optics close together",
      .separated_by = separations::kOtherPressure,
      .turns_into = {{Limit::tied_to_runs, "offset"}},
      .traits = {.is_drift = true,
                 .of_condition = true,
                 .shows_at_zero = true,
                 .until_new_set_up = true,
                 .of_measurement = true},
      .place = Place::sense,
      .needs = {Need::air},
      .preference = 130,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = air_deviation_ppm(at.data, at.k); },
      .of_sense = [](const Site& site) { return site.once(!is_rotation(site.sense)); },
  };
}

}  // namespace ecs::model::effects
