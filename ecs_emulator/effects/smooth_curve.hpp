// A smooth curve over a travel, and the drawing of one.
#pragma once

#include <vector>

#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

/// Legendre polynomials of degree 2, 3, …; a mean and a slope where the effect keeps them.
struct SmoothCurve {
  double from_mm = 0.0;
  double to_mm = 1.0;
  double mean = 0.0;
  double slope = 0.0;         ///< over half the range
  std::vector<double> waves;  ///< of degree 2, 3, …
  [[nodiscard]] bool empty() const { return waves.empty() && mean == 0.0 && slope == 0.0; }
};

/// Beyond the range the end value holds.
[[nodiscard]] double value_at(const SmoothCurve& curve, double p_mm);

/// Without mean and slope, size about 1. @param places_mm  ascending, not empty: the curve runs over them
[[nodiscard]] SmoothCurve draw_curve(Random& random, const std::vector<double>& places_mm);

}  // namespace ecs::emulator
