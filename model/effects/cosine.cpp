// Laser not aligned with the axis, −p·φ²/2: shortens, never lengthens.
#include "model/effects/definition.hpp"

namespace ecs::model::effects {

EffectDefinition cosine() {
  return {
      .id = "cosine",
      .title = "Cosine error",
      .formula = "-p phi^2/2",
      .cause = "laser not aligned with the axis",
      .tells_apart = "always shortens: a slope of one sign only",
      .check = "move the axis over its travel and watch the returned beam on the detector: it must not walk",
      .headline = "a cosine error in {where}, with the beam {angle_mrad} off the axis",
      .parameters = {{"angle_mrad", "mrad", "misalignment", Coding::square_root}},
      .carrier = Carrier::set_up,
      .how = "an error of the measurement: align the beam",
      .separated_by = {60,
                       "Realign the laser along {axis} and repeat: a cosine error changes, a scale error does not."},
      .traits = {.until_new_set_up = true, .of_measurement = true},
      .preference = 80,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = -5e-4 * at.p_mm(); },
      .along_axis = [](const Site& site) { return site.once(site.is_positioning()); },
  };
}

}  // namespace ecs::model::effects
