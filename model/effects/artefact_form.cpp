// The form of a straight edge: readings across an axis hold it once as it is and once with the other sign when the
// edge is turned over (reversal: ISO 230-1; Evans, Hocken and Estler 1996).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition artefact_form() {
  return {
      .id = "artefact_form",
      .title = "Form of the straight edge",
      .formula = "r (c + s(p)), r = -1 if turned over",
      .cause = "the straight edge or the leg of the square is not straight",
      .tells_apart =
          "changes its sign when the artefact is turned over (column reversed); an error of the machine does not",
      .check = "read the certificate of the straight edge; turn it over and measure again",
      .headline = "a straight edge that is not straight, {rms_um} in {where}",
      .parameters = {{"rms_um", "um", "size of the curve", Coding::size_of_curve}},
      .carrier = Carrier::set_up,
      .how = "an error of the artefact: subtract half the difference between its readings as it is and turned over",
      .separated_by = separations::kTurnedOver,
      .traits = {.is_curve = true,
                 .keeps_mean = true,
                 .shape_of_position = true,
                 .is_smooth = true,
                 .of_measurement = true,
                 .one_per_axis = true},
      .needs = {Need::reversed},
      .preference = 86,
      .curve_factor = [](const ReadingAt& at) { return side_of_artefact(at); },
      .along_axis = [](const Site& site) { return site.once(site.is_across() && site.places >= kFewestCurveTargets); },
  };
}

}  // namespace ecs::model::effects
