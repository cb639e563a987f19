#include "ecs_emulator/instruments/interferometer.hpp"

#include <cmath>
#include <numbers>

#include "base/units.hpp"
#include "ecs_emulator/instruments/refraction.hpp"

namespace ecs::emulator {
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
