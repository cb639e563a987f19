// Roll, pitch or yaw ε(p) of a carriage acting through a lever L (rigid bodies; component errors of ISO 230-1).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition angular() {
  return {
      .id = "angular",
      .title = "Angular error",
      .formula = "eps(p) L",
      .cause = "roll, pitch or yaw of a carriage acting through an offset",
      .tells_apart = "proportional to the distance from the line on which the axis was measured",
      .check =
          "mount an autocollimator or a level on the carriage and move the axis; inspect ways, gibs and wipers where "
          "the angle changes",
      .headline = "an angular error {code} of the {axis} carriage of {rms_um}, acting through a lever arm",
      .parameters = {{"rms_um", "um/m", "size of the angle", Coding::size_of_curve}},
      .carrier = Carrier::error_map,
      .how = "a table of the angle; the unit multiplies by the lever arm",
      .separated_by = separations::kSecondLine,
      .traits = {.is_curve = true,
                 .keeps_mean = true,
                 .keeps_slope = true,
                 .shape_of_position = true,
                 .is_smooth = true,
                 .one_per_axis = true},
      .place = Place::rotation,
      .curve_factor = [](const ReadingAt& at) { return lever_m(at.data, at.k, *at.effect.code); },
  };
}

}  // namespace ecs::model::effects
