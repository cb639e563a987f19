// Which runs a person could do next: the line measured now under other conditions, other targets, another line.
// Does not live here: what each of them would tell (separation.hpp).
#pragma once

#include <vector>

#include "model/data/observations.hpp"
#include "model/planning/run.hpp"

namespace ecs::model {

/// One line as it is measured now: the most frequent parked place of an axis moved and a sense read.
struct PresentLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  MeasurementProposal now;  ///< the line as it is, one run
  std::size_t readings = 0;
};
/// Most readings first.
[[nodiscard]] std::vector<PresentLine> present_lines(const Observations& data, const MeasuringTimes& times);

/// The way that an axis may take: its travel, else what was measured.
[[nodiscard]] Range range_of(const Observations& data, Axis axis);

/// The targets chosen for a run, moved where the present ones lie at equal steps: there a period has aliases.
[[nodiscard]] std::vector<double> off_equal_steps(const std::vector<double>& present_mm, std::vector<double> chosen_mm);

/// Runs worth weighing, one run of each: every condition with many and with few targets, both ways and one way.
/// @param of_approach  causes that depend on the approach are in question: both ways only
/// @param on_the_fly   readings without a dwell, as a following error needs
[[nodiscard]] std::vector<MeasurementProposal> measuring_options(const Observations& data, const PresentLine& line,
                                                                 const MeasuringTimes& times, bool of_approach,
                                                                 bool on_the_fly);

}  // namespace ecs::model
