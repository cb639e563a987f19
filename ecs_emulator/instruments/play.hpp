// Hysteresis of a pivot or a plunger: what is shown stays until the input has taken up the play.
// Does not live here: how wide it is (ecs_emulator/settings/laser.hpp).
#pragma once

#include <algorithm>

namespace ecs::emulator {

class Play {
 public:
  /// @param width  between what is shown going up and going down
  explicit Play(double width) : half_(0.5 * width) {}

  void start_at(double value) { shown_ = value; }
  [[nodiscard]] double follow(double value) {
    shown_ = std::clamp(shown_, value - half_, value + half_);
    return shown_;
  }

 private:
  double half_;
  double shown_ = 0.0;
};

}  // namespace ecs::emulator
