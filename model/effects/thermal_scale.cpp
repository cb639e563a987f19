// Expansion of screw or scale, α·p·(T − 20 °C), T of the material (ISO 230-3, reference temperature of ISO 1); T may
// follow the sensor late.
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition thermal_scale() {
  return {
      .id = "thermal_scale",
      .title = "Thermal expansion",
      .formula = "alpha p (T - 20)",
      .cause = "screw or scale expands with temperature",
      .tells_apart = "a slope that follows the material's temperature",
      .check =
          "compare the temperature of screw or scale with the sensor used for the material, and check its coefficient "
          "in the machine file",
      .headline = "an expansion of {um_per_m_degC} in {where} with the material's temperature",
      .parameters = {lag_parameter(), {"um_per_m_degC", "um/m/degC", "expansion"}},
      .carrier = Carrier::inputs,
      .live = {{"um_per_m_degC", ThermalLaw::growth, LiveSource::material}},
      .how = "a thermal row of the map that follows the material's temperature",
      .separated_by = separations::kOtherTemperature,
      .turns_into = {{Limit::at_least, "thermal_scale"}, {Limit::at_greatest, "thermal_scale"}},
      .traits = {.has_lag = true, .of_condition = true, .one_per_axis = true},
      .needs = {Need::material_temperature},
      .preference = 70,
      .columns = [](const ReadingAt& at,
                    std::span<double> row) { row[0] = at.p_m() * (acting_degC(at) - kReference_degC); },
      .search = time_constants(),
      .along_axis = [](const Site& site) { return at_once_and_late(site, site.once()); },
  };
}

}  // namespace ecs::model::effects
