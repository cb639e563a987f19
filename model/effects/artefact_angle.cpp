// The angle error of a square: readings across an axis lean, and lean the other way when the square is turned over
// (reversal: ISO 230-1, squareness with a reference square; Estler and others 2002 for the principle).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition artefact_angle() {
  return {
      .id = "artefact_angle",
      .title = "Angle error of the square",
      .formula = "r (k p + c), r = -1 if turned over",
      .cause = "the square or straight edge is not at its assumed angle",
      .tells_apart =
          "changes its sign when the artefact is turned over (column reversed); an error of the machine does not",
      .check = "read the certificate of the square; turn it over and measure again",
      .headline = "an error of {um_per_m} of the square used for {readings}",
      .parameters = {{"um_per_m", "um/m", "angle error"}, {"um", "um", "half of the zero shift on turning over"}},
      .carrier = Carrier::set_up,
      .how = "an error of the artefact: subtract half the difference between its readings as it is and turned over",
      .separated_by = separations::kTurnedOver,
      .traits = {.of_measurement = true, .one_per_axis = true},
      .needs = {Need::reversed},
      .preference = 85,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            row[0] = side_of_artefact(at) * at.p_m();
            row[1] = side_of_artefact(at);
          },
      .column_sets = {{0}, {0, 1}},
      .along_axis = [](const Site& site) { return site.once(site.is_across()); },
  };
}

}  // namespace ecs::model::effects
