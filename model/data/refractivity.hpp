// Refractive index of air from temperature, pressure and humidity, as a deviation from the reference air.
#pragma once

namespace ecs::model {

/// Deviation of the refractive index from that of 20 °C, 1013.25 hPa, 50 %RH, in 1e-6, for 633 nm.
/// Modified Edlén equation (Bönsch and Potulski, Metrologia 35 (1998) 133, eqs. 6a, 9); water vapour pressure after
/// Magnus (Sonntag 1990). Good to 0.1e-6 in workshop air.
[[nodiscard]] double refractivity_deviation_ppm(double air_degC, double pressure_hPa, double humidity_pct);

}  // namespace ecs::model
