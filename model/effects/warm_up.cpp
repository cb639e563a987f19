// Growth of a machine that warms itself, without a sensor that sees it: c·(1 − exp(−t/tau)) and the same × p
// (ISO 230-3:2020, 7; Bryan 1990).
#include <algorithm>
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition warm_up() {
  return {
      .id = "warm_up",
      .title = "Warming up",
      .formula = "c (1 - exp(-t/tau)), and the same multiplied by p",
      .cause = "self-heating without a sensor",
      .tells_apart = "fast at first, then it levels off",
      .check =
          "switch on from cold, keep the axis at rest and watch the drift; mount a sensor at the nearest source of "
          "heat",
      .headline = "a drift in {where} as the machine warms up, towards {sizes} with a time constant of {tau_s}",
      .parameters = {{"tau_s", "s", "time constant", Coding::searched},
                     {"c_um", "um", "final shift"},
                     {"c_um_per_m", "um/m", "final change of scale"}},
      .carrier = Carrier::inputs,
      .live = {{"c_um", ThermalLaw::shift, LiveSource::motion}, {"c_um_per_m", ThermalLaw::growth, LiveSource::motion}},
      .how = "a thermal row of the map that follows the motion of an axis",
      .separated_by = separations::kFromCold,
      .turns_into = {{Limit::at_least, "offset"}, {Limit::at_greatest, "time_drift"}},
      .traits = {.is_drift = true, .shows_at_zero = true, .from_origin = true},
      .place = Place::sense,
      .needs = {Need::time},
      .preference = 110,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            row[0] = -std::expm1(-std::max(0.0, at.data.since_origin_s(at.k)) / at.searched);  // it begins at 0
            row[1] = row[0] * at.p_m();
          },
      .column_sets = {{0}, {1}, {0, 1}},
      .column_sets_elsewhere = {{1}, {1, 0}},
      .search = time_constants(),
      .of_sense = [](const Site& site) { return site.once(!site.any_axis_varies); },
      .along_axis = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
