// Air and temperatures of an environment log, joined by time to measurements.
#pragma once

#include <optional>

#include "base/result.hpp"
#include "laser/environment_series.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Gives every reading the conditions at its time, linear between the rows of the log; beyond its ends those of the
/// end. What a reading has of its own stays. Where both state dates they meet there, else the log begins with the
/// first reading. A log without times has a row every `every_s` seconds; absent: its rows are spread evenly over the
/// readings (over their order, where they have no time). The notes say which of these, and how far the log reaches.
/// `usage` if the readings have no time and the log has.
[[nodiscard]] Result<void> join_environment(MeasurementSet& set, const EnvironmentSeries& series,
                                            std::optional<double> every_s);

}  // namespace ecs::laser
