// A slope k·p over the position: lead of a screw, factor of a scale.
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition scale() {
  return {
      .id = "scale",
      .title = "Scale error",
      .formula = "k p",
      .cause = "screw lead or scale factor wrong",
      .tells_apart = "grows with position; constant in time and temperature",
      .check =
          "along the axis, check the scale factor of the control, and the expansion coefficient and material "
          "temperature entered at the laser; across it, the alignment of the optics, then the squareness",
      .headline = "a {slope} of {um_per_m} in {where}",
      .parameters = {{"um_per_m", "um/m", "slope (across the axis: squareness or alignment)"}},
      .carrier = Carrier::error_map,
      .how = "a table of the error map",
      .separated_by = separations::kFinerTargets,
      .traits = {.is_usual = true, .one_per_axis = true},
      .preference = 10,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = at.p_m(); },
      .along_axis = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
