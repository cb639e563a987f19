// A slope k·p over the position: lead of a screw, factor of a scale. Across the axis it is that of the optics too,
// which are aligned again for every line (ISO 230-1: straightness counts from a line fitted to the readings).
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

namespace {

/// The slope of the axis, and that of further lines across it. An artefact that is turned over shows its own.
std::vector<EffectInstance> of_lines(const Site& site) {
  std::vector<EffectInstance> each = site.once();
  if (site.is_across() && !site.data.rotary && !site.data.extras.contains("reversed"))
    for (EffectInstance& one : site.on_further_lines()) each.push_back(std::move(one));
  return each;
}

}  // namespace

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
      .traits = {.of_lines = true, .is_usual = true, .one_per_axis = true},
      .preference = 10,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = at.p_m(); },
      .along_axis = of_lines,
  };
}

}  // namespace ecs::model::effects
