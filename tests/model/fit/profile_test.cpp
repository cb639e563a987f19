// Sigma of a decay length and its size by profile likelihood.
#include <cmath>

#include <doctest/doctest.h>

#include "model/fit/fit.hpp"
#include "tests/model/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

TEST_CASE("size and length of a reversal spike lie within three sigma of the truth, far from a straight law too") {
  Model model = straight();
  model.effects.push_back(effect(effects::reversal_spike, Axis::X, Sense::EX));
  int inside = 0, counted = 0;
  constexpr double kSize_um = 1.2, kLength_mm = 45.0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    laser::MeasurementSet set = measured({.targets = 21, .runs = 2}, 0.3, nothing, seed);
    for (laser::Reading& r : set.readings) {
      r.travel_since_reversal_mm = r.approach == Approach::forward ? 30.0 + p(r) : 530.0 - p(r);
      r.error += kSize_um * d(r) * std::exp(-*r.travel_since_reversal_mm / kLength_mm);
    }
    const auto found = fit(model, observations_of(set, model, mill()));
    REQUIRE(found);
    for (const ParameterEstimate& one : found->effects.back().parameters) {
      ++counted;
      const double truth = one.name == "c_um" ? kSize_um : kLength_mm;
      if (!one.sigma || std::abs(one.value - truth) <= 3.0 * *one.sigma) ++inside;
    }
  }
  CHECK(counted == 300);
  CHECK(inside >= 294);
}
