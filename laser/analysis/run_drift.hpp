// Whether the runs of a measured line agree with each other, or drift from run to run.
// Does not live here: single readings that are far from their repeats (pipeline.hpp: outliers_of).
#pragma once

#include <optional>
#include <vector>

#include "laser/groups.hpp"

namespace ecs::laser {

/// How far one run lies from the mean of all runs [um or um/m].
struct RunOffset {
  int run = 0;
  double offset = 0.0;
  double sigma = 0.0;  ///< standard error of the offset
  std::size_t readings = 0;
};

struct RunDrift {
  std::vector<RunOffset> runs;  ///< ascending by number; the offsets have the mean 0
  double per_run = 0.0;         ///< slope of the offsets over the number of the run, in the order of the runs
  double per_run_sigma = 0.0;
  double first_to_last = 0.0;  ///< what that slope makes of all runs
  bool drifts = false;         ///< the slope is significant
  std::vector<int> apart;      ///< runs significantly off the line of the others
};

/// The offsets of the runs of a group. Nothing where they cannot be told from the scatter: fewer than three runs, or
/// fewer than ten readings more than there are runs and places.
[[nodiscard]] std::optional<RunDrift> run_drift_of(const MeasurementSet& set, const Group& group);

}  // namespace ecs::laser
