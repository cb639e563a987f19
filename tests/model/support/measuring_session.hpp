// One session of measuring for the tests of the next measurement.
#pragma once

#include <functional>
#include <random>

#include "base/random.hpp"
#include "tests/model/support/measured_lines.hpp"

namespace ecs::model::test {

/// One session; `conditions` changes every reading before the truth is asked.
inline laser::MeasurementSet session(const Plan& plan, const Truth& truth,
                                     const std::function<void(laser::Reading&)>& conditions) {
  auto set = measured(plan, 0.0, [](const laser::Reading&) { return 0.0; });
  std::mt19937_64 random(11);
  NormalDraws noise(0.0, kNoise_um);
  for (auto& r : set.readings) {
    r.sensors_degC.clear();
    conditions(r);
    r.error = truth(r) + noise(random);
  }
  return set;
}

}  // namespace ecs::model::test
