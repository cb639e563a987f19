// Wavelength not corrected for air, p·Δn (Edlén 1966; Birch and Downs 1994).
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition air_refraction() {
  return {
      .id = "air_refraction",
      .title = "Missing correction for air",
      .formula = "p dn(T_air, pressure, humidity)",
      .cause = "the laser's wavelength was not corrected for air",
      .tells_apart = "a slope that follows the refractive index of air",
      .check = "compare pressure, temperature and humidity at the beam with the values used by the laser's electronics",
      .headline = "a missing correction for air in {where}, {factor} of the full amount",
      .parameters =
          {{.name = "factor", .unit = "", .meaning = "1 = not corrected at all", .limits = ValueRange{0.0, 2.0}}},
      .carrier = Carrier::set_up,
      .how = "an error of the measurement: correct the readings for air",
      .separated_by = separations::kOtherPressure,
      .traits = {.of_condition = true, .of_measurement = true},
      .needs = {Need::air},
      .preference = 90,
      .columns = [](const ReadingAt& at,
                    std::span<double> row) { row[0] = at.p_m() * air_deviation_ppm(at.data, at.k); },
      .along_axis = [](const Site& site) { return site.once(site.is_positioning()); },
  };
}

}  // namespace ecs::model::effects
