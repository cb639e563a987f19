// The temperatures of sensors over the time of a measurement, and what follows them late: a structure that takes its
// temperature through a resistance to heat (first-order low-pass).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/data/sensor_noise.hpp"

namespace ecs::model {

struct Observations;

/// Temperatures of all readings of a measurement, also of those that a part of it leaves out: what follows late does
/// not forget them.
struct SensorHistory {
  std::vector<int> clock;            ///< by reading: which time it is on; readings of one clock follow one another
  std::vector<double> time_s;        ///< NaN: not measured
  std::vector<std::size_t> in_time;  ///< readings with a time, by their clocks, on each in order of time
  std::map<std::string, std::vector<double>, std::less<>> sensors_degC;
  std::map<std::string, CourseWithoutNoise, std::less<>> without_noise;  ///< of the sensors that are noisy or coarse
};

/// Null where there are no times or no sensors. Where some reading has no time, each run has a clock of its own.
[[nodiscard]] std::shared_ptr<const SensorHistory> sensor_history_of(const Observations& data);

/// Temperature of what follows a sensor with this time constant, in each reading: τ dF/dt = T − F, with F = T at the
/// first reading of each clock (a steady state) and T on a straight line from reading to reading, without the noise of
/// a noisy sensor. At once where the lag is 0 or the reading has no time; kNotMeasured where the sensor was not read.
/// Below 0: as smooth, but not late.
[[nodiscard]] std::vector<double> followed_degC(const Observations& data, std::string_view sensor, double lag_s);
/// What the noise of the sensor leaves unknown of it, as a standard deviation [degC]; empty: nothing.
[[nodiscard]] std::vector<double> unknown_degC(const Observations& data, std::string_view sensor, double lag_s);

}  // namespace ecs::model
