// Abbe offset of the measurement, c·ε(p): the map was measured on another line, ε is a known rotation (Bryan 1979).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition measurement_line() {
  return {
      .id = "measurement_line",
      .title = "Abbe offset of the measurement",
      .formula = "c eps_known(p)",
      .cause = "the map was measured on a different line from the present one",
      .tells_apart = "has the shape of an angular error that was measured separately",
      .check = "compare the measurement line in the unit's parameters with the position of the optics",
      .headline = "{readings} measured {lever_mm} off the line of the map, which shows the angle {code}",
      .parameters = {{"lever_mm", "mm", "distance between the lines"}},
      .carrier = Carrier::parameters,
      .how = "the measurement line in the unit's parameters",
      .separated_by = separations::kSecondLine,
      .traits = {.one_per_axis = true},
      .place = Place::known_component,
      .needs = {Need::known},
      .preference = 60,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const double position_mm = at.data.position_mm[at.k][index_of(*at.effect.axis)];
            row[0] = known_value(at.data, *at.effect.code, position_mm) / 1000.0;
          },
      .along_axis =
          [](const Site& site) {
            std::vector<EffectInstance> all;
            for (const KnownComponent& known : site.data.known) {
              if (is_rotation(site.sense) || moving_axis(known.code) != site.axis || !is_angular(known.code)) continue;
              all.push_back(site.once().front());
              all.back().code = known.code;
            }
            return all;
          },
  };
}

}  // namespace ecs::model::effects
