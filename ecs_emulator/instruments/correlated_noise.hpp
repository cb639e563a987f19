// Noise that remembers itself for a while (Ornstein-Uhlenbeck): moving air in a beam, standard deviation 1.
// Does not live here: how strong it is (ecs_emulator/settings/laser.hpp).
#pragma once

#include <cmath>
#include <optional>

#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

class CorrelatedNoise {
 public:
  /// @param time_s  correlation time: after it, e⁻¹ of a deviation is left
  explicit CorrelatedNoise(double time_s) : time_s_(time_s) {}

  /// @pre calls in the order of time
  [[nodiscard]] double at(double now_s, Random& random) {
    const double kept = last_s_ ? std::exp(-(now_s - *last_s_) / time_s_) : 0.0;
    last_s_ = now_s;
    value_ = kept * value_ + std::sqrt(1.0 - kept * kept) * random.normal();
    return value_;
  }

 private:
  double time_s_;
  std::optional<double> last_s_;
  double value_ = 0.0;
};

}  // namespace ecs::emulator
