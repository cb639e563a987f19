// Linear regression of growth on a temperature with a lag of the first order, T' = (T_sensor − T)/tau (ISO 230-3:2020
// asks for drift at one place against temperatures over time; the lag as in a lumped thermal body, e.g. J. Mayr et al.,
// CIRP Annals 61 (2012) 771). The lag is sought on a logarithmic grid.
#include "laser/analysis/growth.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastReadings = 10;
constexpr double kLeast_s = 60.0;
constexpr double kHour_s = 3600.0;
constexpr int kLagsADecade = 50;

struct Samples {
  std::vector<double> time_s, error;
};

/// The readings in order of time.
std::vector<const Reading*> in_time(const MeasurementSet& set, const Group& group) {
  std::vector<const Reading*> readings;
  for (const std::size_t i : group.readings) readings.push_back(&set.readings[i]);
  std::stable_sort(readings.begin(), readings.end(),
                   [](const Reading* a, const Reading* b) { return *a->time_s < *b->time_s; });
  return readings;
}

/// A signal after a lag of the first order, steady before the first value; exact for straight lines between values.
std::vector<double> delayed(const std::vector<double>& time_s, const std::vector<double>& signal, double lag_s) {
  std::vector<double> out = signal;
  if (lag_s <= 0.0) return out;
  for (std::size_t i = 1; i < signal.size(); ++i) {
    const double step_s = time_s[i] - time_s[i - 1];
    const double slope = step_s > 0.0 ? (signal[i] - signal[i - 1]) / step_s : 0.0;
    const double steady = signal[i] - slope * lag_s;
    out[i] = steady + (out[i - 1] - (signal[i - 1] - slope * lag_s)) * std::exp(-step_s / lag_s);
  }
  return out;
}

struct Regression {
  double slope = 0.0, explained = 0.0, rms_left = 0.0;
};

Regression line_through(const std::vector<double>& x, const std::vector<double>& y) {
  const double mean_x = *mean_of(x), mean_y = *mean_of(y);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  if (!(xx > 0.0) || !(yy > 0.0)) return {};
  const double explained = xy * xy / (xx * yy);
  return {xy / xx, explained, std::sqrt(std::max(0.0, yy * (1.0 - explained)) / static_cast<double>(y.size()))};
}

SensorGrowth growth_with(const std::string& sensor, const Samples& samples, const std::vector<double>& temperature) {
  const double span_s = samples.time_s.back() - samples.time_s.front();
  const double least_s = span_s / static_cast<double>(samples.time_s.size());
  std::vector<double> lags{0.0};
  for (double lag_s = least_s; lag_s < span_s; lag_s *= std::pow(10.0, 1.0 / kLagsADecade)) lags.push_back(lag_s);
  SensorGrowth best{sensor};
  for (const bool sensor_lags : {false, true})
    for (const double lag_s : lags) {
      const Regression line = sensor_lags ? line_through(temperature, delayed(samples.time_s, samples.error, lag_s))
                                          : line_through(delayed(samples.time_s, temperature, lag_s), samples.error);
      if (line.explained > best.explained)
        best = {sensor, line.slope, sensor_lags ? -lag_s : lag_s, line.explained, line.rms_left};
    }
  return best;
}

double range_from(const Samples& samples, double from_s) {
  std::optional<double> least, most;
  for (std::size_t i = 0; i < samples.error.size(); ++i) {
    if (samples.time_s[i] < from_s) continue;
    least = std::min(least.value_or(samples.error[i]), samples.error[i]);
    most = std::max(most.value_or(samples.error[i]), samples.error[i]);
  }
  return most ? *most - *least : 0.0;
}

}  // namespace

std::optional<Growth> growth_of(const MeasurementSet& set, const Group& group) {
  const auto is_timed = [&](std::size_t i) { return set.readings[i].time_s.has_value(); };
  if (group.readings.size() < kLeastReadings || !std::all_of(group.readings.begin(), group.readings.end(), is_timed) ||
      targets_of(set, group, target_tolerance_mm(set, group)).size() != 1)
    return std::nullopt;
  const auto readings = in_time(set, group);
  Samples samples;
  for (const Reading* reading : readings) {
    samples.time_s.push_back(*reading->time_s);
    samples.error.push_back(reading->error);
  }
  const double span_s = samples.time_s.back() - samples.time_s.front();
  if (!(span_s > kLeast_s)) return std::nullopt;
  Growth growth{span_s / kHour_s,
                range_from(samples, samples.time_s.front()),
                range_from(samples, samples.time_s.back() - kHour_s),
                {}};
  for (const std::string& sensor : sensor_names_of(set)) {
    Samples measured;
    std::vector<double> temperature;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const auto found = readings[i]->sensors_degC.find(sensor);
      if (found == readings[i]->sensors_degC.end()) continue;
      measured.time_s.push_back(samples.time_s[i]);
      measured.error.push_back(samples.error[i]);
      temperature.push_back(found->second);
    }
    if (temperature.size() >= kLeastReadings) growth.sensors.push_back(growth_with(sensor, measured, temperature));
  }
  std::stable_sort(growth.sensors.begin(), growth.sensors.end(),
                   [](const SensorGrowth& a, const SensorGrowth& b) { return a.explained > b.explained; });
  return growth;
}

}  // namespace ecs::laser
