// Phase refractive index of moist air for visible and near infrared light, after
// P. E. Ciddor, Refractive index of air: new equations for the visible and near infrared, Appl. Opt. 35 (1996) 1566.
// Does not live here: what an interferometer makes of it (interferometer.hpp), the weather (the machine's
// surroundings).
#pragma once

#include "ecs_emulator/thermal/heat.hpp"

namespace ecs::emulator {

inline constexpr double kHeNe_nm = 632.9908;  ///< vacuum wavelength of a stabilised helium-neon laser
inline constexpr double kCo2_ppm = 450.0;     ///< of laboratory air, as in Ciddor's standard air
/// What an instrument assumes whose air compensation is switched off, and from which docs/physics.md counts air.
inline constexpr Air kReferenceAir{};

/// Saturation pressure of water vapour [Pa]: over water above 0 °C (IAPWS-IF97, region 4), over ice below it (IAPWS
/// 1993), as the NIST wavelength calculator has them. Valid −40 … 100 °C.
[[nodiscard]] double saturation_pressure_Pa(double temperature_degC);

/// Mole fraction of water vapour, x_w = f·h·p_sv/p with Ciddor's enhancement factor f (appendix A).
[[nodiscard]] double vapour_fraction(const Air& air);

/// Ciddor's equations 1–5 with the compressibility and density of BIPM 1981/91 (appendix A, equation 12).
/// Valid 300 … 1700 nm, −40 … 100 °C, 80 … 120 kPa (tests reach 50 … 140 kPa).
/// @param vapour_fraction  mole fraction of water vapour
[[nodiscard]] double refractive_index(double temperature_degC, double pressure_Pa, double vapour_fraction,
                                      double vacuum_wavelength_nm, double co2_ppm);

/// The same for air as it is measured.
[[nodiscard]] double refractive_index(const Air& air, double vacuum_wavelength_nm = kHeNe_nm,
                                      double co2_ppm = kCo2_ppm);

}  // namespace ecs::emulator
