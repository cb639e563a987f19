// The errors of a rotary axis as a model of one turn: offset, reversal and waves that fit a whole number of times into
// 360 degrees. Does not live here: models of linear axes (model/), statistics by target (iso230.hpp).
#pragma once

#include <optional>
#include <vector>

#include "laser/groups.hpp"

namespace ecs::laser {

/// amplitude × cos(order × angle − phase), in the unit of the readings.
struct TurnWave {
  int order = 1;  ///< waves in a turn; the period is 360 deg / order
  double amplitude = 0.0;
  double amplitude_sigma = 0.0;  ///< standard error
  double phase_deg = 0.0;        ///< of the wave, 0 to 360
  double p_value = 1.0;          ///< that noise alone gives it (F test)
};

struct TurnModel {
  double offset = 0.0;
  std::optional<double> reversal;  ///< forward less reverse; absent: one approach only, or unknown
  std::vector<TurnWave> waves;     ///< those that stand out of the noise, the largest first
  int most_waves = 0;              ///< orders that were tried, from `least_waves` on
  int least_waves = 1;             ///< 1 where a whole turn was measured
  double rms = 0.0;                ///< of the readings about their mean
  double rms_left = 0.0;           ///< of what the model leaves
  double explained = 0.0;          ///< 1 − (rms_left / rms)²
};

/// @param group  of a rotary axis: positions in degrees, any number of turns
/// Nothing for other axes, or fewer than eight angles.
[[nodiscard]] std::optional<TurnModel> turn_of(const MeasurementSet& set, const Group& group);

}  // namespace ecs::laser
