// The readings of a log that were taken at rest, and their means.
// Does not live here: joining the channels of a log (channels.hpp).
#pragma once

#include <optional>

#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Keeps the readings of each axis and sense that stand in a stretch of three or more, one after the other, whose
/// positions lie within `at_rest_mm` of the first of them; with `average` a stretch becomes one reading at its mean
/// position, its error, time, conditions and numbers the means, with `readings_averaged` and `scatter` (standard
/// deviation) beside. Absent: readings at the same place, how many they are, make a stretch. The notes say how many
/// readings were left out and averaged.
void keep_at_rest(MeasurementSet& set, std::optional<double> at_rest_mm, bool average);

}  // namespace ecs::laser
