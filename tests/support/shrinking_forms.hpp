// Error curves with known truth and noise, for the test and the benchmark of shrinking.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "laser/analysis/shrinking.hpp"

namespace ecs::laser {

/// The true error over 0 … 1, by approach (±1), in units of the noise of one reading.
using ErrorForm = std::function<double(double place, double approach)>;

inline std::vector<std::pair<std::string, ErrorForm>> shrinking_forms() {
  using std::numbers::pi;
  const auto wave = [](double waves, double size) {
    return [=](double t, double) { return size * std::sin(2.0 * pi * waves * t + 0.3); };
  };
  return {{"nothing", [](double, double) { return 0.0; }},
          {"a straight line", [](double t, double d) { return 30.0 * t + d; }},
          {"half a wave", wave(0.5, 10.0)},
          {"3 waves", wave(3.0, 3.0)},
          {"17 waves, as large as noise", wave(17.0, 1.0)},
          {"17 waves, half of that", wave(17.0, 0.5)},
          {"a step", [](double t, double) { return t > 0.4 ? 5.0 : 0.0; }},
          {"a comb", [](double t, double) { return std::fmod(std::floor(40.0 * t), 2.0) * 2.0; }},
          {"a reversal that grows", [](double t, double d) { return d * 3.0 * t * t; }}};
}

/// Mean squared error at the targets, both approaches.
struct ShrinkingTrial {
  double plain = 0.0;
  double shrunk = 0.0;
};

/// 41 targets, three runs each way, noise of standard deviation 1 and a pass offset of 0.2.
inline ShrinkingTrial shrinking_trial(const ErrorForm& form, unsigned seed) {
  constexpr int kTargets = 41, kRuns = 3;
  std::mt19937_64 generator(seed);
  NormalDraws normal;
  MeasurementSet set;
  for (int run = 1; run <= kRuns; ++run)
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      const double offset = 0.2 * normal(generator);
      for (int i = 0; i < kTargets; ++i) {
        Reading reading;
        reading.position_mm[0] = 25.0 * i;
        reading.approach = approach;
        reading.run = run;
        reading.error =
            form(static_cast<double>(i) / (kTargets - 1), static_cast<double>(approach)) + offset + normal(generator);
        set.readings.push_back(reading);
      }
    }
  const Group group = groups_of(set).front();
  const Curve plain = *averaged(set, group);
  const Curve less = shrunk(plain, *repeatability_of(set, group)).curve;
  ShrinkingTrial trial;
  for (std::size_t i = 0; i < plain.points.size(); ++i)
    for (const auto side : {&CurvePoint::forward, &CurvePoint::reverse}) {
      const double truth = form(static_cast<double>(i) / (kTargets - 1), side == &CurvePoint::forward ? 1.0 : -1.0);
      trial.plain += std::pow(*(plain.points[i].*side) - truth, 2) / (2.0 * kTargets);
      trial.shrunk += std::pow(*(less.points[i].*side) - truth, 2) / (2.0 * kTargets);
    }
  return trial;
}

}  // namespace ecs::laser
