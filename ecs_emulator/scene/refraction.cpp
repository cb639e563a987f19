#include "ecs_emulator/scene/refraction.hpp"

#include <cmath>

namespace ecs::emulator {

double refractivity(double air_degC, double pressure_hPa, double humidity_pct) {
  constexpr double kWavenumber2 = 1.0 / (0.6329908 * 0.6329908);  // um^-2
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - kWavenumber2) + 15998.0 / (38.9 - kWavenumber2));
  const double pressure_Pa = pressure_hPa * 100.0;
  const double dry = standard * pressure_Pa / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * air_degC) * pressure_Pa) /
                     (1.0 + 0.003661 * air_degC);
  const double saturated_Pa = 611.2 * std::exp(17.62 * air_degC / (243.12 + air_degC));
  return dry - 0.01 * humidity_pct * saturated_Pa * (3.7345 - 0.0401 * kWavenumber2) * 1e-10;
}

double missing_refraction(const Scene& scene, const Stop& stop) {
  return refractivity(scene.degC("t_air_degC", stop, 20.0), stop.weather.pressure_hPa, stop.weather.humidity_pct) -
         refractivity(20.0, 1013.25, 50.0);
}

}  // namespace ecs::emulator
