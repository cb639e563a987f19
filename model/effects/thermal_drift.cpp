// Growth of spindle or column with one sensor, c·(T − T0), T0 its temperature at the origin (ISO 230-3); T may follow
// the sensor late.
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition thermal_drift() {
  return {
      .id = "thermal_drift",
      .title = "Thermal drift",
      .formula = "c (T - T0)",
      .cause = "spindle or column grows with temperature",
      .tells_apart = "the same at every position; follows one sensor",
      .check = "run the spindle or the heat source with the axes at rest and watch the drift with a gauge at the tool",
      .headline = "a drift of {um_per_degC} in {where} with the {sensor} temperature, equal at every position",
      .parameters = {lag_parameter(), {"um_per_degC", "um/degC", "shift"}},
      .carrier = Carrier::inputs,
      .live = {{"um_per_degC", ThermalLaw::shift, LiveSource::sensor}},
      .how = "a thermal row of the map that follows its sensor",
      .separated_by = separations::kOtherTemperature,
      .turns_into = {{Limit::tied_to_runs, "offset"},
                     {Limit::at_least, "thermal_drift"},
                     {Limit::at_greatest, "thermal_drift"}},
      .traits = {.has_lag = true,
                 .is_drift = true,
                 .of_condition = true,
                 .shows_at_zero = true,
                 .from_origin = true,
                 .one_per_axis = true,
                 .on_rotary_axes = true},
      .place = Place::sense,
      .needs = {Need::sensor},
      .preference = 70,
      .columns = [](const ReadingAt& at,
                    std::span<double> row) { row[0] = acting_degC(at) - reference_degC(at.data, at.effect.sensor); },
      .search = time_constants(),
      .of_sense =
          [](const Site& site) {
            std::vector<EffectInstance> all;
            for (const auto& [sensor, column] : site.data.sensors_degC) {
              all.push_back(site.once().front());
              all.back().sensor = sensor;
            }
            return at_once_and_late(site, all);
          },
  };
}

}  // namespace ecs::model::effects
