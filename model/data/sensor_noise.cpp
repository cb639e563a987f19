#include "model/data/sensor_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

#include <Eigen/Core>
#include <Eigen/LU>

#include "laser/groups.hpp"

namespace ecs::model {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// What a good sensor scatters; less does no harm beside the noise of readings.
constexpr double kGoodSensor_degC = 0.02;
/// Coarser steps than these are of temperatures that people note, not of a sensor.
constexpr double kCoarsestStep_degC = 0.25;
constexpr std::size_t kFewestSamples = 12;  ///< for a noise that is known to about a quarter

/// The temperature at one moment; readings of several senses share it.
struct Sample {
  int clock = 0;
  double time_s = 0.0, degC = 0.0;
  std::vector<std::size_t> rows;
};

std::vector<Sample> samples_of(std::span<const int> clock, std::span<const double> time_s,
                               std::span<const double> degC) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < degC.size(); ++k)
    if (!std::isnan(degC[k]) && !std::isnan(time_s[k])) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return std::make_tuple(clock[k], time_s[k]); });
  std::vector<Sample> samples;
  for (const std::size_t k : order) {
    if (samples.empty() || samples.back().clock != clock[k] || samples.back().time_s != time_s[k])
      samples.push_back({clock[k], time_s[k], 0.0, {}});
    samples.back().rows.push_back(k);
    samples.back().degC += (degC[k] - samples.back().degC) / static_cast<double>(samples.back().rows.size());
  }
  return samples;
}

/// From each sample and the straight line between its neighbours.
double scatter_of(const std::vector<Sample>& samples) {
  constexpr double kMedianOfNormal = 0.6745;
  std::vector<double> off;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Sample &before = samples[i - 1], &now = samples[i], &behind = samples[i + 1];
    if (before.clock != behind.clock) continue;
    const double share = (now.time_s - before.time_s) / (behind.time_s - before.time_s);
    const double line = before.degC + share * (behind.degC - before.degC);
    off.push_back(std::abs(now.degC - line) / std::sqrt(1.0 + share * share + (1.0 - share) * (1.0 - share)));
  }
  return laser::median_of(std::move(off)) / kMedianOfNormal;
}

/// Step of which all temperatures are multiples, and from one to the next mostly none or one; 0: there is none.
double step_of(const std::vector<Sample>& samples) {
  constexpr double kSame_degC = 1e-6, kOfStep = 1e-3;
  std::vector<double> levels, changes;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    levels.push_back(samples[i].degC);
    if (i > 0) changes.push_back(std::abs(samples[i].degC - samples[i - 1].degC));
  }
  std::ranges::sort(levels);
  double step = 2.0 * kCoarsestStep_degC;
  for (std::size_t i = 1; i < levels.size(); ++i)
    if (levels[i] - levels[i - 1] > kSame_degC) step = std::min(step, levels[i] - levels[i - 1]);
  const bool is_multiple = std::ranges::all_of(
      levels, [&](double level) { return std::abs(std::remainder((level - levels.front()) / step, 1.0)) < kOfStep; });
  return is_multiple && step <= kCoarsestStep_degC && laser::median_of(std::move(changes)) < (1.0 + kOfStep) * step
             ? step
             : 0.0;
}

/// Value and slope of the course, in units of the noise's variance; times in units of the usual interval.
struct State {
  Vector2d mean = Vector2d::Zero();
  Matrix2d covariance = Matrix2d::Zero();
};
struct Step {
  Matrix2d move = Matrix2d::Identity();
  State before, after;  ///< of the sample
};

/// Kalman filter over the samples, each clock from a state of which nothing is known.
class Filter {
 public:
  /// @param roughness  of the course: variance that its slope gains in one interval
  Filter(const std::vector<Sample>& samples, double interval_s, double roughness) {
    constexpr double kNothingKnown = 1e8;
    State state;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      Step step;
      const bool begins = i == 0 || samples[i].clock != samples[i - 1].clock;
      known_ = begins ? 0 : known_ + 1;
      if (begins) {
        state = {{samples[i].degC, 0.0}, kNothingKnown * Matrix2d::Identity()};
      } else {
        const double h = (samples[i].time_s - samples[i - 1].time_s) / interval_s;
        step.move(0, 1) = h;
        Matrix2d wander;
        wander << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
        state = {step.move * state.mean, step.move * state.covariance * step.move.transpose() + roughness * wander};
      }
      step.before = state;
      const double variance = state.covariance(0, 0) + 1.0, off = samples[i].degC - state.mean(0);
      if (known_ >= 2) {
        ln_variances_ += std::log(variance);
        squares_ += off * off / variance;
        ++innovations_;
      }
      const Vector2d gain = state.covariance.col(0) / variance;
      state.mean += gain * off;
      state.covariance -= gain * state.covariance.row(0).eval();
      step.after = state;
      steps_.push_back(step);
    }
  }

  /// Variance of one sample: the likeliest, no less than that of the step of the sensor.
  [[nodiscard]] double variance(double least) const {
    return std::max(squares_ / static_cast<double>(std::max<std::size_t>(innovations_, 1)), least);
  }
  [[nodiscard]] double deviance(double least) const {
    const double of_one = std::max(variance(least), 1e-30);
    return static_cast<double>(innovations_) * std::log(of_one) + squares_ / of_one + ln_variances_;
  }

  /// Rauch, Tung and Striebel (1965).
  [[nodiscard]] std::vector<State> smoothed(const std::vector<Sample>& samples) const {
    std::vector<State> states(steps_.size());
    for (std::size_t i = steps_.size(); i-- > 0;) {
      states[i] = steps_[i].after;
      if (i + 1 == steps_.size() || samples[i].clock != samples[i + 1].clock) continue;
      const Step& next = steps_[i + 1];
      const Matrix2d back = steps_[i].after.covariance * next.move.transpose() * next.before.covariance.inverse();
      states[i].mean += back * (states[i + 1].mean - next.before.mean);
      states[i].covariance += back * (states[i + 1].covariance - next.before.covariance) * back.transpose();
    }
    return states;
  }

 private:
  std::vector<Step> steps_;
  double squares_ = 0.0, ln_variances_ = 0.0;
  std::size_t innovations_ = 0, known_ = 0;
};

/// log10 of the likeliest roughness: the best power of ten, then golden sections beside it.
double likeliest_roughness(const std::vector<Sample>& samples, double interval_s, double least) {
  constexpr int kSmoothest = -16, kRoughest = 4;
  constexpr double kGolden = 0.6180339887, kFine = 0.02;
  const auto deviance = [&](double log10) {
    return Filter(samples, interval_s, std::pow(10.0, log10)).deviance(least);
  };
  double best = kSmoothest, lowest = deviance(kSmoothest);
  for (int power = kSmoothest + 1; power <= kRoughest; ++power)
    if (const double here = deviance(power); here < lowest) {
      lowest = here;
      best = power;
    }
  double from = best - 1.0, to = best + 1.0;
  while (to - from > kFine) {
    const double low = to - kGolden * (to - from), high = from + kGolden * (to - from);
    const bool is_low = deviance(low) < deviance(high);
    (is_low ? to : from) = is_low ? high : low;
  }
  return 0.5 * (from + to);
}

}  // namespace

bool takes_course(std::span<const double> values) {
  // of independent values the mean square of successive differences is twice the variance, with a standard deviation of
  // 2/sqrt(n) of it (von Neumann 1941); three of these are no chance
  constexpr double kOfIndependent = 2.0, kDeviations = 3.0;
  if (values.size() < 2) return false;
  const auto n = static_cast<double>(values.size());
  double mean = 0.0, differences = 0.0, deviations = 0.0;
  for (const double value : values) mean += value / n;
  for (std::size_t k = 0; k < values.size(); ++k) {
    deviations += (values[k] - mean) * (values[k] - mean);
    if (k > 0) differences += (values[k] - values[k - 1]) * (values[k] - values[k - 1]);
  }
  return differences < (kOfIndependent - kDeviations * 2.0 / std::sqrt(n)) * deviations;
}

std::optional<CourseWithoutNoise> without_noise(std::span<const int> clock, std::span<const double> time_s,
                                                std::span<const double> degC) {
  const std::vector<Sample> samples = samples_of(clock, time_s, degC);
  if (samples.size() < kFewestSamples) return std::nullopt;
  const double of_step_degC = step_of(samples) / std::sqrt(12.0);  // standard deviation of what rounding adds
  if (std::max(scatter_of(samples), of_step_degC) < kGoodSensor_degC) return std::nullopt;
  std::vector<double> values, intervals;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    values.push_back(samples[i].degC);
    if (i > 0 && samples[i].clock == samples[i - 1].clock)
      intervals.push_back(samples[i].time_s - samples[i - 1].time_s);
  }
  if (intervals.empty() || !takes_course(values)) return std::nullopt;
  const double interval_s = laser::median_of(std::move(intervals)), least = of_step_degC * of_step_degC;
  const double roughness = std::pow(10.0, likeliest_roughness(samples, interval_s, least));
  const Filter filter(samples, interval_s, roughness);
  CourseWithoutNoise course{{degC.begin(), degC.end()},
                            std::vector<double>(degC.size(), 0.0),
                            std::sqrt(filter.variance(least)),
                            interval_s / std::pow(roughness, 0.25)};
  if (course.noise_degC < kGoodSensor_degC) return std::nullopt;
  const std::vector<State> states = filter.smoothed(samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (const std::size_t k : samples[i].rows) {
      course.degC[k] = states[i].mean(0);
      course.sd_degC[k] = course.noise_degC * std::sqrt(std::max(states[i].covariance(0, 0), 0.0));
    }
  return course;
}

}  // namespace ecs::model
