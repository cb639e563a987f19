// Refractive index of air from what a weather station measures, by the two equations that calibration laboratories use;
// positioning errors referred to 20 °C by one coefficient of expansion, and back again (thesis 6.3.1).
// Does not live here: machines whose parts expand differently (model/).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

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

inline constexpr double kReference_degC = 20.0;  ///< ISO 1

/// How the errors are referred to 20 °C.
struct Normalisation {
  double coefficient_um_per_m_degC = 0.0;          ///< of the result; 0: as the machine is at its own temperature
  std::optional<double> instrument_um_per_m_degC;  ///< what the instrument applied already; absent: as the file says
                                                   ///< (Renishaw `Exp coeff`), 0 if it says nothing
  std::string sensor = "t_material_degC";          ///< column with the temperature of the scale
  std::optional<double> material_degC;             ///< one temperature for all readings, instead of the sensor
  double fixed_mm = 0.0;                           ///< position of the moving axis that expansion leaves where it is
};

struct Normalised {
  MeasurementSet set;       ///< errors referred to 20 °C; each reading keeps what it was in `kBeforeNormalisation`
  std::size_t changed = 0;  ///< readings along their own axis
  double instrument_um_per_m_degC = 0.0;  ///< taken as applied by the instrument
  double least_degC = 0.0;                ///< of the material over the readings that changed
  double most_degC = 0.0;
  double largest_um = 0.0;          ///< largest size of a change
  double per_coefficient_um = 0.0;  ///< largest change if the coefficient were wrong by 1 um/(m °C)
  std::vector<std::string> notes;   ///< which coefficient, what of it may be wrong and why
};

/// Column that holds the error before it was referred to 20 °C: the way back, to the last bit.
inline constexpr std::string_view kBeforeNormalisation = "reading_before_normalisation";

/// error20 = error − (coefficient − instrument)·(T − 20)·(position − fixed). Only errors along the moving axis change.
/// `refused`: no such error, a reading without temperature, a set that is referred to 20 °C already, a temperature
/// outside −50 … 150 °C, a coefficient outside ±1000.
[[nodiscard]] Result<Normalised> normalised(const MeasurementSet& set, const Normalisation& how);

/// The set as it was. `refused` if nothing was normalised.
[[nodiscard]] Result<MeasurementSet> denormalised(const MeasurementSet& set);

/// The coefficient that a Renishaw file says the instrument applied (`Exp coeff`, ppm/°C).
[[nodiscard]] std::optional<double> instrument_coefficient(const MeasurementSet& set);

}  // namespace ecs::laser
