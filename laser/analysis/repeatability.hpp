// How well the readings of a measured line repeat: what differs from reading to reading, and what differs from pass to
// pass (one run, one approach). Does not live here: ISO 230-2 (iso230.hpp), runs that drift (run_drift.hpp).
#pragma once

#include <optional>

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

}  // namespace ecs::laser
