// A Michelson interferometer with a retro-reflector, in wavelengths: what its counter counts and its display shows.
// Does not live here: noise and the display's last digit (laser.hpp), where the reflector is (the machine).
#pragma once

#include "ecs_emulator/settings/emulator.hpp"
#include "ecs_emulator/thermal/heat.hpp"

namespace ecs::emulator {

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
