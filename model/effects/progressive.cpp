// A smooth curve s(p) over the position, mean and slope removed: wear and form of a guideway.
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition progressive() {
  return {
      .id = "progressive",
      .title = "Progressive error",
      .formula = "s(p)",
      .cause = "wear of screw or guideway, form of the guideway",
      .tells_apart = "a smooth curve over position, the same in both approaches, with no single period",
      .check =
          "for positioning, compare with the certificate of screw or scale; for straightness, with a straight edge; "
          "check for wear where the axis works most",
      .headline = "a smooth error along the travel in {where}, {rms_um}",
      .parameters = {{"rms_um", "um", "size of the curve", Coding::size_of_curve}},
      .carrier = Carrier::error_map,
      .how = "a table of the error map",
      .separated_by = separations::kFinerTargets,
      .traits = {.is_curve = true, .shape_of_position = true, .is_smooth = true, .one_per_axis = true},
      .preference = 20,
      .curve_factor = [](const ReadingAt&) { return 1.0; },
      .along_axis = [](const Site& site) { return site.once(site.places >= kFewestCurveTargets); },
  };
}

}  // namespace ecs::model::effects
