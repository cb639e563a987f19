// What lies between the nut of the screw and the slide that it moves: play, and the wind-up of screw and nut under
// friction. Does not live here: geometry of the guideway (ecs_emulator/errors/true_errors.hpp).
#pragma once

#include <algorithm>
#include <cmath>

namespace ecs::emulator {

struct SlideSettings {
  double lost_motion_um = 0.0;     ///< play between nut and slide
  double wind_up_um = 0.0;         ///< how far friction holds the slide back, each way
  double wind_up_length_mm = 1.0;  ///< the wind-up reverses over this travel, exponentially; above 0
};

/// The slide stays within the play of the nut, and hangs back by the wind-up: from one full wind-up to the other it is
/// δ = c·(1 − 2·e^(−u/u₀)), u = travel since the reversal (the friction model of Dahl, 1968, exponent 1).
class Slide {
 public:
  Slide(const SlideSettings& settings, double nut_mm)
      : settings_(settings), nut_mm_(nut_mm), driven_mm_(nut_mm), slide_mm_(nut_mm) {}

  void follow(double nut_mm) {
    const double moved_mm = nut_mm - nut_mm_;
    nut_mm_ = nut_mm;
    if (settings_.wind_up_um > 0.0) {
      const double full_mm = std::copysign(settings_.wind_up_um * 1e-3, moved_mm);
      wind_up_mm_ += (full_mm - wind_up_mm_) * std::min(1.0, std::abs(moved_mm) / settings_.wind_up_length_mm);
    }
    const double play_mm = 0.5e-3 * settings_.lost_motion_um;
    driven_mm_ = std::clamp(driven_mm_, nut_mm - play_mm, nut_mm + play_mm);
    slide_mm_ = driven_mm_ - wind_up_mm_;
  }
  [[nodiscard]] double position_mm() const { return slide_mm_; }

 private:
  SlideSettings settings_;
  double nut_mm_ = 0.0;
  double driven_mm_ = 0.0;
  double wind_up_mm_ = 0.0;
  double slide_mm_ = 0.0;
};

}  // namespace ecs::emulator
