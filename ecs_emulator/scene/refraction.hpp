// Refraction of the air at a stop. Does not live here: Ciddor's equations of the virtual laser
// (ecs_emulator/instruments/refraction.hpp).
#pragma once

#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

/// Refractive index of air less 1, at 633 nm: Edlén's equation as revised by Birch and Downs (Metrologia 30, 1993, 155;
/// 31, 1994, 315), with the Magnus formula for the vapour pressure.
[[nodiscard]] double refractivity(double air_degC, double pressure_hPa, double humidity_pct);
/// n − n at 20 °C, 1013.25 hPa, 50 %RH. Air temperature of the stop's sensor t_air_degC.
[[nodiscard]] double missing_refraction(const Scene& scene, const Stop& stop);

}  // namespace ecs::emulator
