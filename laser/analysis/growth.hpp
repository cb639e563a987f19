// Growth at one target over time, as in the tests of ISO 230-3: its size, and how it follows each sensor.
// Does not live here: effects of a model (model/effects), several targets (iso230.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "laser/groups.hpp"

namespace ecs::laser {

/// error = constant + coefficient × temperature, one of them delayed by a lag of the first order, which begins with
/// each stretch of time.
struct SensorGrowth {
  std::string sensor;      ///< column
  double per_degC = 0.0;   ///< um/degC, or um/m per degC
  double lag_s = 0.0;      ///< positive: the growth follows the sensor so much later; negative: the sensor lags
  double explained = 0.0;  ///< share of the squares of the errors about their mean that this explains, 0 to 1
  double rms_left = 0.0;   ///< of the errors, or of the delayed errors where the sensor lags
};

struct Growth {
  double hours = 0.0;                 ///< from the first reading to the last, of the longest stretch
  double range = 0.0;                 ///< largest minus smallest
  double range_last_hour = 0.0;       ///< over the last hour: what had not settled; the largest of the stretches
  std::size_t stretches = 1;          ///< how often the time begins: each run has a clock of its own where they overlap
  std::vector<SensorGrowth> sensors;  ///< those that explain more first
};

/// Nothing unless all readings of the group are at one target, ten or more, with times of more than a minute.
[[nodiscard]] std::optional<Growth> growth_of(const MeasurementSet& set, const Group& group);

}  // namespace ecs::laser
