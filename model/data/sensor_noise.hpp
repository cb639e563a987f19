// The course of a temperature without the noise and the steps of its sensor. Does not live here: what follows it late
// (sensor_history.hpp).
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace ecs::model {

/// The expected temperature given all that its sensor has read. As a regressor it has no error that its coefficient
/// would be too small for (regression calibration: Carroll et al. 2006, Measurement Error in Nonlinear Models, 4).
struct CourseWithoutNoise {
  std::vector<double> degC;     ///< by reading; where the sensor or the time was not read as it was
  std::vector<double> sd_degC;  ///< what is not known of it
  double noise_degC = 0.0;      ///< standard deviation of one reading of the sensor
  double memory_s = 0.0;        ///< over which the errors of the course are alike
};

/// A cubic smoothing spline (an integrated random walk: Wahba 1978), its smoothness and the noise by likelihood.
/// Nothing where the sensor is about as good as any (0.02 degC), or where its temperature takes no course.
/// @param clock  by reading: which time it is on
[[nodiscard]] std::optional<CourseWithoutNoise> without_noise(std::span<const int> clock,
                                                              std::span<const double> time_s,
                                                              std::span<const double> degC);

/// Whether successive values are more alike than values in any order, beyond chance.
[[nodiscard]] bool takes_course(std::span<const double> values);

}  // namespace ecs::model
