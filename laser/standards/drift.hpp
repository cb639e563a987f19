// Drift at one place over time: the environmental temperature variation error (ETVE) and the distortion by a moving
// axis or a spindle, ISO 230-3. Does not live here: how drift follows each sensor (laser/analysis/growth.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// One sense at one place. Values in um, or um/m for a rotation.
struct Drift {
  Sense sense = Sense::EX;
  std::vector<double> time_h;      ///< from the first reading of the set, ascending
  std::vector<double> value;       ///< less the first
  double hours = 0.0;              ///< from the first to the last reading
  double range = 0.0;              ///< largest less smallest over the whole test: the ETVE of that time
  double window_range = 0.0;       ///< largest range within any window of the wanted length: what a measurement meets
  double window_from_h = 0.0;      ///< where that window begins
  double last_window_range = 0.0;  ///< within the last window: what had not settled
};

/// Temperatures beside them, over the same time.
struct DriftSensor {
  std::string name;  ///< column
  std::vector<double> time_h, degC;
};

struct DriftTest {
  double window_h = 1.0;
  std::vector<Drift> senses;
  std::vector<DriftSensor> sensors;
};

/// Refuses sets without times, with a sense at more than one place or of fewer than ten readings, and tests shorter
/// than twice the window. @param window_h  length of the windows, above 0
[[nodiscard]] Result<DriftTest> drift_test_of(const MeasurementSet& set, double window_h);

}  // namespace ecs::laser
