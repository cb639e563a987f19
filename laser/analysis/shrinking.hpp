// Curves shrunk below their own noise: what repeats cannot tell from scatter is taken away, and no more.
// Does not live here: smoothing by a window that a person chooses (process.hpp).
#pragma once

#include <string>

#include "laser/analysis/curve.hpp"
#include "laser/analysis/repeatability.hpp"

namespace ecs::laser {

struct Shrunk {
  Curve curve;
  double removed_rms = 0.0;  ///< of before − after, all points and approaches
  double kept = 1.0;         ///< degrees of freedom of the curve that are left, as a share
};

/// The straight line of the means and the mean reversal error stay; what is left is turned into cosines along the
/// targets, and each octave of them is shrunk towards zero by the positive-part rule of James and Stein (Proc. 4th
/// Berkeley Symp. 1 (1961) 361; by blocks: T. T. Cai, Ann. Statist. 27 (1999) 898). Its expected squared error at the
/// targets is not above that of the plain means, whatever the curve is.
/// Mean and reversal error are shrunk apart where every target has both approaches, else each approach.
/// @param repeatability  of the readings that the means are of
[[nodiscard]] Shrunk shrunk(const Curve& curve, const Repeatability& repeatability);

}  // namespace ecs::laser
