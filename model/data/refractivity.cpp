#include "model/data/refractivity.hpp"

#include <cmath>

namespace ecs::model {
namespace {

/// (n − 1)·1e6
double refractivity_ppm(double air_degC, double pressure_hPa, double humidity_pct) {
  constexpr double kWavelength_um = 0.6329914;
  const double s2 = 1.0 / (kWavelength_um * kWavelength_um);
  const double standard = 1e-8 * (8091.37 + 2333983.0 / (130.0 - s2) + 15518.0 / (38.9 - s2));
  const double pressure_Pa = 100.0 * pressure_hPa;
  const double dry = standard * pressure_Pa / 93214.60 * (1.0 + 1e-8 * (0.5953 - 0.009876 * air_degC) * pressure_Pa) /
                     (1.0 + 0.0036610 * air_degC);
  const double vapour_Pa = humidity_pct / 100.0 * 611.2 * std::exp(17.62 * air_degC / (243.12 + air_degC));
  return 1e6 * (dry - vapour_Pa * (3.8020 - 0.0384 * s2) * 1e-10);
}

}  // namespace

double refractivity_deviation_ppm(double air_degC, double pressure_hPa, double humidity_pct) {
  return refractivity_ppm(air_degC, pressure_hPa, humidity_pct) - refractivity_ppm(20.0, 1013.25, 50.0);
}

}  // namespace ecs::model
