// The stops of a measurement that is to be taken by hand: which target comes when, from which side. Does not live here:
// taking the readings (capture_record.hpp).
#pragma once

#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::devices {

/// A line of evenly spaced targets, measured forward and back as often as there are runs.
struct CaptureLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  double from_mm = 0.0;
  double to_mm = 0.0;
  double step_mm = 0.0;  ///< its sign does not matter; a last short step ends at `to_mm`
  int runs = 3;
  bool moved = false;    ///< targets moved off equal steps (base/moved_targets.hpp)
  bool one_way = false;  ///< back to the first target without readings
  Vector3 parked_mm{};   ///< where the other axes stand
  std::optional<double> feed_mm_min;
};

struct CapturePlan {
  std::vector<laser::MetadataEntry> metadata;
  std::vector<laser::Reading> stops;  ///< in the order of measuring; `error` and `time_s` mean nothing yet
};

/// @pre nothing. A `usage` problem says what is wrong with step, range or runs.
[[nodiscard]] Result<std::vector<laser::Reading>> stops_of(const CaptureLine& line);

/// The rows of a target list (`ecs model next --targets`) in file order. `bad_input` where a row names no approach.
[[nodiscard]] Result<std::vector<laser::Reading>> stops_of_targets(const laser::MeasurementSet& targets);

/// Stops belong to one pass where axis, sense, run and approach are the same.
[[nodiscard]] bool same_pass(const laser::Reading& a, const laser::Reading& b);

}  // namespace ecs::devices
