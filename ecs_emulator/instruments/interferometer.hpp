// A Michelson interferometer with a retro-reflector, in wavelengths: the phase refractive index of moist air for
// visible and near infrared light, what the counter counts and the display shows. The index after P. E. Ciddor,
// Refractive index of air: new equations for the visible and near infrared, Appl. Opt. 35 (1996) 1566. Does not live
// here: noise and the display's last digit (laser.hpp), the weather (ecs_emulator/thermal/heat.hpp).
#pragma once

#include "ecs_emulator/settings/emulator.hpp"
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

/// What the instrument's own sensors make of the air.
[[nodiscard]] Air sensed(const Air& air, const LaserSettings& settings);

/// Counter N = 2·(n·L − n₀·L_d)/λ, with the path L = L_d + displacement·cos φ + lateral·sin φ; display =
/// (N·λ/2 + L_e·(n̂₀ − n̂))/n̂/(1 + α(T̂ − 20)): n the index of the air, n̂ what the instrument takes it for, L_e the dead
/// path that has been entered.
class Interferometer {
 public:
  explicit Interferometer(const LaserSettings& settings) : settings_(settings) {}

  /// The display is set to zero, here and now. The first time is the set-up: manual air is measured then.
  void reset(const Air& air);

  /// @param displacement_mm  of the reflector since the reset, along the axis, positive away from the interferometer
  /// @param lateral_mm       the same across, in the direction in which the beam is tilted
  [[nodiscard]] double displayed_mm(double displacement_mm, double lateral_mm, const Air& air,
                                    double material_degC) const;

 private:
  [[nodiscard]] double index(const Air& air) const;          ///< n
  [[nodiscard]] double assumed_index(const Air& air) const;  ///< n̂
  [[nodiscard]] double normalisation(double material_degC) const;
  [[nodiscard]] double counted(double fringes) const;

  LaserSettings settings_;
  bool set_up_ = false;
  double manual_index_ = 1.0;
  double reset_index_ = 1.0;          ///< n₀
  double reset_assumed_index_ = 1.0;  ///< n̂₀
};

}  // namespace ecs::emulator
