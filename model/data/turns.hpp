// Sine and cosine of an angle, exactly 0 where only rounding keeps them from it.
#pragma once

#include <cmath>

namespace ecs::model {

/// At targets that are whole multiples of a period its sine is 0: what rounding leaves of it (1e-12) would be fitted
/// with amplitudes of metres.
[[nodiscard]] inline double unless_rounding(double value) { return std::abs(value) < 1e-9 ? 0.0 : value; }
[[nodiscard]] inline double sine_of(double angle_rad) { return unless_rounding(std::sin(angle_rad)); }
[[nodiscard]] inline double cosine_of(double angle_rad) { return unless_rounding(std::cos(angle_rad)); }

}  // namespace ecs::model
