// Refractive index of air from what a weather station measures, by the two equations that calibration laboratories use.
// Does not live here: what an interferometer made of it, expansion of material (normalise.hpp).
#pragma once

#include "base/result.hpp"

namespace ecs::laser {

/// Air in the beam.
struct BeamAir {
  double temperature_degC = 20.0;
  double pressure_hPa = 1013.25;
  double humidity_pct = 50.0;  ///< relative, over water above 0 °C and over ice below
  double co2_ppm = 450.0;      ///< Ciddor alone uses it
  friend bool operator==(const BeamAir&, const BeamAir&) = default;
};

inline constexpr double kRedHeNe_nm = 632.9905770;  ///< vacuum wavelength of a stabilised helium-neon laser [nm]

enum class AirEquation {
  ciddor,         ///< P. E. Ciddor, Appl. Opt. 35 (1996) 1566, in the arrangement of the NIST wavelength calculator
  modified_edlen  ///< G. Boensch, E. Potulski, Metrologia 35 (1998) 133 as NIST simplifies it (Birch and Downs 1994)
};

/// Phase refractive index. `refused` outside 300 … 1700 nm, −40 … 100 °C, 100 … 1400 hPa, 0 … 100 %, 0 … 2000 ppm.
[[nodiscard]] Result<double> refractive_index(const BeamAir& air, double vacuum_wavelength_nm = kRedHeNe_nm,
                                              AirEquation equation = AirEquation::ciddor);

/// How far the index differs from that of the reference air, `BeamAir{}`, in 1e-6, by Ciddor. Never fails: what lies
/// outside the range of the equation counts as the end of the range.
[[nodiscard]] double refractive_index_deviation_ppm(BeamAir air, double vacuum_wavelength_nm = kRedHeNe_nm);

/// Saturation pressure of water vapour [Pa]: over water from 0 °C (IAPWS-IF97), over ice below (IAPWS 1993).
[[nodiscard]] double water_vapour_saturation_Pa(double temperature_degC);

}  // namespace ecs::laser
