// How well the readings of a measured line repeat: what differs from reading to reading, and what differs from pass to
// pass (one run, one approach); and curves shrunk below their own noise: what repeats cannot tell from scatter is taken
// away, and no more. Does not live here: ISO 230-2 (iso230.hpp), runs that drift (run_drift.hpp), smoothing by a window
// that a person chooses (process.hpp).
#pragma once

#include <optional>

#include "laser/analysis/curve.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {

/// Standard deviations of single readings [um or um/m].
struct Repeatability {
  double reading = 0.0;  ///< independent at each target
  double pass = 0.0;     ///< common to a pass: smooth along the travel, root mean square over it
  double repeats = 0.0;  ///< readings at a target by one approach, on average
  int reading_freedom = 0;
  int pass_freedom = 0;  ///< passes less one, of each approach
};

/// Variance components of the deviations of passes from their mean: the part on an offset, a straight line and two
/// waves along the travel against the rest (one-way random effects, S. R. Searle, G. Casella, C. E. McCulloch, Variance
/// Components, Wiley 1992, 3.5: a negative estimate counts as 0).
/// Nothing where no target was read twice by the same approach.
[[nodiscard]] std::optional<Repeatability> repeatability_of(const MeasurementSet& set, const Group& group);

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
