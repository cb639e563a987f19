// A proposed run, stop by stop: where the axis stops, how it came there, and how long it takes.
// Does not live here: which runs to propose (options.hpp), the part program (part_program.hpp).
#pragma once

#include <array>
#include <vector>

#include "model/planning/next_measurement.hpp"
#include "params/machine.hpp"

namespace ecs::model {

inline constexpr double kSecondsAMinute = 60.0, kMinutesAnHour = 60.0;

/// A load for a machine measured without one: a choice.
inline constexpr double kTypicalLoad_kg = 100.0;

/// To a micrometre, as a control takes positions.
[[nodiscard]] double to_micrometre(double mm);

/// One reading of a run.
struct Stop {
  double target_mm = 0.0;  ///< on a circle the angle [deg]
  int approach = 1;
  int run = 1;
  double feed_mm_min = 0.0;
  double since_reversal_mm = 0.0;  ///< travel since the last reversal
  double after_s = 0.0;            ///< since the start of the program
};

/// Stops in the order in which they are visited: run by run, pass by pass; the second feed after the first.
/// @param rapid_mm_min  for the way to the overrun
[[nodiscard]] std::vector<Stop> stops_of(const MeasurementProposal& proposal, double rapid_mm_min = 6000.0);

/// Senses of approach (1 or -1) of the passes of one run, in order.
[[nodiscard]] std::vector<int> pass_senses(const MeasurementProposal& proposal);

/// Everything [min]: waiting, setting up, moving, dwelling. Accelerations are neglected.
[[nodiscard]] double minutes_of(const MeasurementProposal& proposal, const MeasuringTimes& times);

/// Lower and upper end of the way that an axis may take [mm].
using Range = std::array<double, 2>;

}  // namespace ecs::model
