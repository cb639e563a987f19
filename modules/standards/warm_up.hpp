// The drifts of ISO 230-3, with ranges of a curve within windows of time. At one place over time: the environmental
// temperature variation error (ETVE) and the distortion by a moving axis or a spindle. By a moving linear axis: it
// moves between places near its ends while it warms itself, readings are taken at both again and again (ISO 230-3,
// "thermal distortion caused by moving linear axes"). Does not live here: how drift follows each sensor
// (laser/analysis/growth.hpp), what a unit can do about it (model/effects/warm_up.cpp).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

struct WindowRanges {
  double whole = 0.0;           ///< largest less smallest value
  double first = 0.0;           ///< within the window that begins with the first value
  double largest = 0.0;         ///< the largest within any window
  double largest_from_h = 0.0;  ///< where that window begins
  double last = 0.0;            ///< within the window that ends with the last value
};

/// @param time_h  ascending, as many as values, one at least
[[nodiscard]] WindowRanges window_ranges(std::span<const double> time_h, std::span<const double> value,
                                         double window_h);

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

/// a + c·(1 − e^(−t/tau)), least squares. Standard uncertainties count the scatter as white.
struct Settling {
  double change = 0.0, change_uncertainty = 0.0;  ///< c
  double time_constant_h = 0.0, time_constant_uncertainty_h = 0.0;
  double to_come = 0.0;  ///< of the change after the end of the test, as a share of c
};

/// Readings at one place from one side, or the difference of two places. Values in um, or um/m for a rotation.
struct WarmUpCurve {
  Sense sense = Sense::EX;
  double position_mm = 0.0;
  Approach approach = Approach::unknown;
  std::vector<double> time_h;        ///< from the first reading of the set, ascending
  std::vector<double> value;         ///< less the first
  double range = 0.0;                ///< over the whole test
  double first_range = 0.0;          ///< within the first window
  double last_range = 0.0;           ///< within the last window
  bool settled = false;              ///< last_range at most kSettledShare of first_range
  std::optional<Settling> settling;  ///< none: no change, or not one that an exponential describes within the test
};

/// The outer places against each other: growth along the axis (its own sense), or a tilt of the line.
struct WarmUpDifference {
  WarmUpCurve curve;  ///< value at `to_mm` less that at `position_mm`, straight between readings
  double to_mm = 0.0;
  double range_um_per_m = 0.0;  ///< range over the distance; 0 for rotations
};

struct WarmUpTest {
  Axis axis = Axis::X;
  double window_h = 1.0;
  double hours = 0.0;  ///< from the first to the last reading
  std::vector<WarmUpCurve> curves;
  std::vector<WarmUpDifference> differences;
};

/// The test may end when the last window shows less than this share of the first.
inline constexpr double kSettledShare = 0.15;

/// Refuses sets without times, of rotary axes or of several axes, fewer than two places of a sense, fewer than ten
/// readings at a place from one side, and tests shorter than twice the window. @param window_h  above 0
[[nodiscard]] Result<WarmUpTest> warm_up_test_of(const MeasurementSet& set, double window_h);

}  // namespace ecs::laser
