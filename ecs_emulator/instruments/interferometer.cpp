#include "ecs_emulator/instruments/interferometer.hpp"

#include <cmath>
#include <numbers>

#include "base/units.hpp"

namespace ecs::emulator {
namespace {

constexpr double kZero_K = 273.15;
constexpr double kGas_J_molK = 8.314510;    ///< as in Ciddor's appendix A
constexpr double kWater_kg_mol = 0.018015;  ///< M_w

/// Z of moist air (appendix A, equation 12).
double compressibility(double temperature_degC, double pressure_Pa, double x) {
  const double t = temperature_degC;
  const double ratio = pressure_Pa / (t + kZero_K);
  const double first = 1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t * t + (5.707e-6 - 2.051e-8 * t) * x +
                       (1.9898e-4 - 2.376e-6 * t) * x * x;
  return 1.0 - ratio * first + ratio * ratio * (1.83e-11 - 0.765e-8 * x * x);
}

/// Molar mass of dry air [kg/mol].
double molar_mass(double co2_ppm) { return 1e-3 * (28.9635 + 12.011e-6 * (co2_ppm - 400.0)); }

/// Density of a part with the molar mass `mass` and the mole fraction `share` of moist air [kg/m³].
double density(double temperature_degC, double pressure_Pa, double vapour_share, double share, double mass) {
  const double z = compressibility(temperature_degC, pressure_Pa, vapour_share);
  return pressure_Pa * share * mass / (z * kGas_J_molK * (temperature_degC + kZero_K));
}

/// Refractivity of standard air, 15 °C, 101325 Pa, dry (equations 1 and 2).
double standard_air(double wave_number2, double co2_ppm) {
  const double at_450_ppm = 1e-8 * (5'792'105.0 / (238.0185 - wave_number2) + 167'917.0 / (57.362 - wave_number2));
  return at_450_ppm * (1.0 + 0.534e-6 * (co2_ppm - 450.0));
}

/// Refractivity of water vapour at 20 °C and 1333 Pa (equation 3).
double standard_vapour(double wave_number2) {
  const double s = wave_number2;
  return 1.022e-8 * (295.235 + 2.6422 * s - 0.032380 * s * s + 0.004028 * s * s * s);
}

/// IAPWS-IF97, equation 30.
double over_water_Pa(double temperature_degC) {
  const double kelvin = temperature_degC + kZero_K;
  const double v = kelvin - 0.23855557567849 / (kelvin - 650.17534844798);
  const double a = v * v + 1167.0521452767 * v - 724213.16703206;
  const double b = -17.073846940092 * v * v + 12020.82470247 * v - 3232555.0322333;
  const double c = 14.91510861353 * v * v - 4823.2657361591 * v + 405113.40542057;
  return 1e6 * std::pow(2.0 * c / (-b + std::sqrt(b * b - 4.0 * a * c)), 4.0);
}

/// IAPWS 1993, sublimation.
double over_ice_Pa(double temperature_degC) {
  const double ratio = (temperature_degC + kZero_K) / 273.16;
  return 611.657 * std::exp(-13.928169 * (1.0 - std::pow(ratio, -1.5)) + 34.7078238 * (1.0 - std::pow(ratio, -1.25)));
}

}  // namespace

double saturation_pressure_Pa(double temperature_degC) {
  return temperature_degC >= 0.0 ? over_water_Pa(temperature_degC) : over_ice_Pa(temperature_degC);
}

double vapour_fraction(const Air& air) {
  const double t = air.temperature_degC;
  const double pressure_Pa = air.pressure_hPa * kPaPerHPa;
  const double enhancement = 1.00062 + 3.14e-8 * pressure_Pa + 5.6e-7 * t * t;
  return enhancement * (air.humidity_pct / 100.0) * saturation_pressure_Pa(t) / pressure_Pa;
}

double refractive_index(double temperature_degC, double pressure_Pa, double vapour_fraction,
                        double vacuum_wavelength_nm, double co2_ppm) {
  const double wave_number2 = 1e6 / (vacuum_wavelength_nm * vacuum_wavelength_nm);  // per um²
  const double air_mass = molar_mass(co2_ppm);
  const double dry = density(temperature_degC, pressure_Pa, vapour_fraction, 1.0 - vapour_fraction, air_mass);
  const double vapour = density(temperature_degC, pressure_Pa, vapour_fraction, vapour_fraction, kWater_kg_mol);
  const double standard_dry = density(15.0, 101'325.0, 0.0, 1.0, air_mass);
  const double standard_wet = density(20.0, 1333.0, 1.0, 1.0, kWater_kg_mol);
  return 1.0 + dry / standard_dry * standard_air(wave_number2, co2_ppm) +
         vapour / standard_wet * standard_vapour(wave_number2);
}

double refractive_index(const Air& air, double vacuum_wavelength_nm, double co2_ppm) {
  return refractive_index(air.temperature_degC, air.pressure_hPa * kPaPerHPa, vapour_fraction(air),
                          vacuum_wavelength_nm, co2_ppm);
}

namespace {

constexpr double kMmPerNm = 1e-6;

}  // namespace

Air sensed(const Air& air, const LaserSettings& settings) {
  return {air.temperature_degC + settings.air_sensor_error_degC, air.pressure_hPa + settings.pressure_sensor_error_hPa,
          air.humidity_pct + settings.humidity_sensor_error_pct};
}

double Interferometer::index(const Air& air) const { return refractive_index(air, settings_.wavelength_nm); }

double Interferometer::assumed_index(const Air& air) const {
  if (settings_.air_compensation == Compensation::off) return index(kReferenceAir);
  if (settings_.air_compensation == Compensation::manual && set_up_) return manual_index_;
  return index(sensed(air, settings_));
}

double Interferometer::normalisation(double material_degC) const {
  if (settings_.material_compensation == Compensation::off) return 1.0;
  const double taken_degC = settings_.material_compensation == Compensation::manual
                                ? settings_.material_degC
                                : material_degC + settings_.material_sensor_error_degC;
  return 1.0 + settings_.expansion_um_per_m_degC * 1e-6 * (taken_degC - 20.0);
}

/// The phase of mixed polarisations runs ahead and behind with every fringe, and the counter has whole counts only.
double Interferometer::counted(double fringes) const {
  const double fringe_nm = settings_.wavelength_nm / 2.0;
  const double mixed = fringes + settings_.nonlinearity_nm / fringe_nm *
                                     std::sin(2.0 * std::numbers::pi * settings_.nonlinearity_cycles * fringes);
  return settings_.fringe_parts > 0.0 ? std::round(mixed * settings_.fringe_parts) / settings_.fringe_parts : mixed;
}

void Interferometer::reset(const Air& air) {
  if (!set_up_) manual_index_ = assumed_index(air);
  set_up_ = true;
  reset_index_ = index(air);
  reset_assumed_index_ = assumed_index(air);
}

double Interferometer::displayed_mm(double displacement_mm, double lateral_mm, const Air& air,
                                    double material_degC) const {
  const double tilt = settings_.misalignment_mrad * 1e-3;
  const double moved_mm = displacement_mm * std::cos(tilt) + lateral_mm * std::sin(tilt);
  const double dead_mm = settings_.dead_path_m * kMmPerM;
  const double n = index(air);
  const double assumed = assumed_index(air);
  const double fringe_mm = settings_.wavelength_nm * kMmPerNm / 2.0;
  const double path_mm = n * moved_mm + (n - reset_index_) * dead_mm;  // optical, since the reset
  const double entered_mm = settings_.dead_path_compensation ? dead_mm : 0.0;
  const double counted_mm = counted(path_mm / fringe_mm) * fringe_mm;
  return (counted_mm + entered_mm * (reset_assumed_index_ - assumed)) / assumed / normalisation(material_degC);
}

}  // namespace ecs::emulator
