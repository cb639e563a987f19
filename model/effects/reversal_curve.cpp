// Lost motion that varies along the axis, s(p)·d/2: a worn nut, a sagging screw.
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition reversal_curve() {
  return {
      .id = "reversal_curve",
      .title = "Reversal error along the axis",
      .formula = "s(p) d/2",
      .cause = "lost motion that varies along the axis: worn nut, screw sag",
      .tells_apart = "forward and reverse curves drift apart along the axis",
      .check =
          "measure the reversal with a dial gauge at both ends and in the middle; check for wear of the nut, loss of "
          "preload and a long unsupported screw",
      .headline = "lost motion that varies along the travel in {where}, {rms_um}",
      .parameters = {{"rms_um", "um", "size of the curve", Coding::size_of_curve}},
      .carrier = Carrier::error_map,
      .how = "forward and reverse tables",
      .separated_by = separations::kAfterReversal,
      .traits = {.is_curve = true,
                 .keeps_slope = true,
                 .of_approach = true,
                 .shape_of_position = true,
                 .is_smooth = true,
                 .one_per_axis = true,
                 .on_rotary_axes = true},
      .preference = 20,
      .curve_factor = [](const ReadingAt& at) { return 0.5 * at.approach() * reading_slope(at.data, at.k); },
      .of_reversal = [](const Site& site) { return site.once(site.places >= kFewestCurveTargets); },
  };
}

}  // namespace ecs::model::effects
