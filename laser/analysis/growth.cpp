// Linear regression of growth on a temperature with a lag of the first order, T' = (T_sensor − T)/tau (ISO 230-3:2020
// asks for drift at one place against temperatures over time; the lag as in a lumped thermal body, e.g. J. Mayr et al.,
// CIRP Annals 61 (2012) 771). The lag is sought on a logarithmic grid, inside stretches of one clock: a lag begins with
// each of them.
#include "laser/analysis/growth.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastReadings = 10;
constexpr double kLeast_s = 60.0;
constexpr double kHour_s = 3600.0;
constexpr int kLagsADecade = 50;

/// Readings of one clock, in order of time.
using Stretch = std::vector<const Reading*>;

struct Samples {
  std::vector<double> time_s, error;
  std::vector<bool> begins;  ///< the first of its stretch
  [[nodiscard]] std::size_t stretches() const { return static_cast<std::size_t>(std::ranges::count(begins, true)); }
};

double first_s(const Stretch& stretch) { return *stretch.front()->time_s; }
double last_s(const Stretch& stretch) { return *stretch.back()->time_s; }

/// The readings of a run, cut where their time goes back; as one stretch, in order of time, where the file is in no
/// order of time at all.
std::vector<Stretch> stretches_of_run(Stretch run) {
  constexpr std::size_t kLeastRows = 3;  // a clock that begins again gives more rows before it does so again
  std::vector<Stretch> stretches;
  for (const Reading* reading : run) {
    if (stretches.empty() || *reading->time_s < last_s(stretches.back())) stretches.emplace_back();
    stretches.back().push_back(reading);
  }
  if (kLeastRows * stretches.size() <= run.size()) return stretches;
  std::ranges::stable_sort(run, [](const Reading* a, const Reading* b) { return *a->time_s < *b->time_s; });
  return {std::move(run)};
}

/// Stretches that follow each other in time are one; where any two overlap, each has a clock of its own.
std::vector<Stretch> stretches_of(const MeasurementSet& set, const Group& group) {
  std::map<int, Stretch> runs;
  for (const std::size_t i : group.readings) runs[set.readings[i].run].push_back(&set.readings[i]);
  std::vector<Stretch> all;
  for (auto& [number, run] : runs)
    for (Stretch& stretch : stretches_of_run(std::move(run))) all.push_back(std::move(stretch));
  std::ranges::stable_sort(all, [](const Stretch& a, const Stretch& b) { return first_s(a) < first_s(b); });
  for (std::size_t s = 1; s < all.size(); ++s)
    if (first_s(all[s]) < last_s(all[s - 1])) return all;
  Stretch whole;
  for (const Stretch& stretch : all) whole.insert(whole.end(), stretch.begin(), stretch.end());
  return {std::move(whole)};
}

/// A signal after a lag of the first order, steady before the first value of each stretch; exact for straight lines
/// between values.
std::vector<double> delayed(const Samples& samples, const std::vector<double>& signal, double lag_s) {
  std::vector<double> out = signal;
  if (lag_s <= 0.0) return out;
  for (std::size_t i = 1; i < signal.size(); ++i) {
    if (samples.begins[i]) continue;
    const double step_s = samples.time_s[i] - samples.time_s[i - 1];
    if (!(step_s > 0.0)) {  // nothing follows in no time
      out[i] = out[i - 1];
      continue;
    }
    const double slope = (signal[i] - signal[i - 1]) / step_s;
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

/// The longest stretch.
double span_of(const Samples& samples) {
  double begun_s = 0.0, span_s = 0.0;
  for (std::size_t i = 0; i < samples.time_s.size(); ++i) {
    if (samples.begins[i]) begun_s = samples.time_s[i];
    span_s = std::max(span_s, samples.time_s[i] - begun_s);
  }
  return span_s;
}

SensorGrowth growth_with(const std::string& sensor, const Samples& samples, const std::vector<double>& temperature) {
  const double span_s = span_of(samples);
  const double least_s = span_s * static_cast<double>(samples.stretches()) / static_cast<double>(samples.time_s.size());
  std::vector<double> lags{0.0};
  for (double lag_s = least_s; least_s > 0.0 && lag_s < span_s; lag_s *= std::pow(10.0, 1.0 / kLagsADecade))
    lags.push_back(lag_s);
  SensorGrowth best{sensor};
  for (const bool sensor_lags : {false, true})
    for (const double lag_s : lags) {
      const Regression line = sensor_lags ? line_through(temperature, delayed(samples, samples.error, lag_s))
                                          : line_through(delayed(samples, temperature, lag_s), samples.error);
      if (line.explained > best.explained)
        best = {sensor, line.slope, sensor_lags ? -lag_s : lag_s, line.explained, line.rms_left};
    }
  return best;
}

/// Of the stretches' last hours the largest range.
double range_of_last_hour(const std::vector<Stretch>& stretches) {
  double largest = 0.0;
  for (const Stretch& stretch : stretches) {
    double least = stretch.back()->error, most = least;
    for (const Reading* reading : stretch) {
      if (*reading->time_s < last_s(stretch) - kHour_s) continue;
      least = std::min(least, reading->error);
      most = std::max(most, reading->error);
    }
    largest = std::max(largest, most - least);
  }
  return largest;
}

}  // namespace

std::optional<Growth> growth_of(const MeasurementSet& set, const Group& group) {
  const auto is_timed = [&](std::size_t i) { return set.readings[i].time_s.has_value(); };
  if (group.readings.size() < kLeastReadings || !std::ranges::all_of(group.readings, is_timed) ||
      targets_of(set, group, target_tolerance_mm(set, group)).size() != 1)
    return std::nullopt;
  const auto stretches = stretches_of(set, group);
  double span_s = 0.0;
  std::vector<double> errors;
  for (const Stretch& stretch : stretches) {
    span_s = std::max(span_s, last_s(stretch) - first_s(stretch));
    for (const Reading* reading : stretch) errors.push_back(reading->error);
  }
  if (!(span_s > kLeast_s)) return std::nullopt;
  const auto [least, most] = std::ranges::minmax_element(errors);
  Growth growth{span_s / kHour_s, *most - *least, range_of_last_hour(stretches), stretches.size(), {}};
  for (const std::string& sensor : sensor_names_of(set)) {
    Samples measured;
    std::vector<double> temperature;
    for (const Stretch& stretch : stretches) {
      bool begins = true;
      for (const Reading* reading : stretch) {
        const auto found = reading->sensors_degC.find(sensor);
        if (found == reading->sensors_degC.end()) continue;
        measured.time_s.push_back(*reading->time_s);
        measured.error.push_back(reading->error);
        measured.begins.push_back(std::exchange(begins, false));
        temperature.push_back(found->second);
      }
    }
    if (temperature.size() >= kLeastReadings) growth.sensors.push_back(growth_with(sensor, measured, temperature));
  }
  std::ranges::stable_sort(growth.sensors,
                           [](const SensorGrowth& a, const SensorGrowth& b) { return a.explained > b.explained; });
  return growth;
}

}  // namespace ecs::laser
