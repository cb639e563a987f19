// Droop k2·e² + k3·e³ over the extension e = |p|: a ram or a beam that bends under its weight.
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition sag() {
  return {
      .id = "sag",
      .title = "Droop",
      .formula = "k2 e^2 + k3 e^3, e = |p|",
      .cause = "ram droop, a beam bending under its weight; across the axis a bent guideway looks the same",
      .tells_apart = "the error grows with the square and cube of the extension, as the bow of a guideway may too",
      .check = "hang a weight on the ram or beam and measure again: droop grows, the bow of a guideway does not",
      .headline = "a bow in {where} that grows with the extension as droop does, {sizes}",
      .parameters = {{"k2", "um/m2", "square"}, {"k3", "um/m3", "cube"}},
      .carrier = Carrier::error_map,
      .how = "a table of the error map",
      .separated_by = separations::kFinerTargets,
      .traits = {.is_smooth = true, .one_per_axis = true},
      .preference = 50,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const double p = at.p_m();
            row[0] = p * p;
            row[1] = std::abs(p) * p * p;
          },
      .column_sets = {{0}, {1}, {0, 1}},
      .along_axis =  // a weight bends across its axis: a bow of the positions is a curve of the scale
      [](const Site& site) { return site.once(!site.is_positioning() && site.places >= kFewestCurveTargets); },
  };
}

}  // namespace ecs::model::effects
