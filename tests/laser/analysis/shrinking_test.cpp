// Shrunk curves are never worse than plain means on average, whatever the curve is, and better where it is smooth.
#include "laser/analysis/shrinking.hpp"

#include <map>

#include "base/random.hpp"
#include "tests/support/shrinking_forms.hpp"
#include "tests/support/test.hpp"

namespace ecs::laser {
namespace {

TEST_CASE("over 200 seeds shrinking is never worse than the plain means, on curves of every form") {
  std::map<std::string, double> ratio;
  for (const auto& [name, form] : shrinking_forms()) {
    double plain = 0.0, less = 0.0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      const ShrinkingTrial trial = shrinking_trial(form, seed);
      plain += trial.plain;
      less += trial.shrunk;
    }
    CAPTURE(name);
    CHECK(less <= plain);
    ratio[name] = less / plain;
  }
  CHECK(ratio["nothing"] < 0.5);
  CHECK(ratio["half a wave"] < 0.6);
}

TEST_CASE("a curve without noise stays as it is, and so do its line and its reversal") {
  Curve curve;
  for (int i = 0; i < 20; ++i) {
    const double value = i % 3;
    curve.points.push_back({10.0 * i, value + 1.0, value - 1.0, 3, 3, 0.0, 0.0});
  }
  const Repeatability silent{0.0, 0.0, 3.0, 40, 4};
  const Shrunk same = shrunk(curve, silent);
  CHECK(same.removed_rms == Approx(0.0));
  const Repeatability loud{100.0, 0.0, 3.0, 40, 4};
  const Shrunk line = shrunk(curve, loud);
  CHECK(*line.curve.points[4].forward - *line.curve.points[4].reverse == Approx(2.0));
  const double step = *line.curve.points[1].forward - *line.curve.points[0].forward;
  CHECK(*line.curve.points[9].forward - *line.curve.points[8].forward == Approx(step));
}

TEST_CASE("repeatability parts what differs from reading to reading from what differs from pass to pass") {
  std::mt19937_64 generator(3);
  NormalDraws normal;
  double reading = 0.0, pass = 0.0;
  constexpr int kSets = 60;
  for (int s = 0; s < kSets; ++s) {
    MeasurementSet set;
    for (int run = 1; run <= 5; ++run)
      for (const Approach approach : {Approach::forward, Approach::reverse}) {
        const double offset = 0.8 * normal(generator), slope = 0.6 * normal(generator);
        for (int i = 0; i <= 40; ++i) {
          Reading one;
          one.position_mm[0] = 10.0 * i;
          one.run = run;
          one.approach = approach;
          one.error = std::sin(0.3 * i) + offset + slope * (i / 20.0 - 1.0) + 1.5 * normal(generator);
          set.readings.push_back(one);
        }
      }
    const auto found = must(repeatability_of(set, groups_of(set).front()));
    CHECK(found.repeats == Approx(5.0));
    CHECK(found.pass_freedom == 8);
    reading += found.reading * found.reading / kSets;
    pass += found.pass * found.pass / kSets;
  }
  CHECK(std::sqrt(reading) == Approx(1.5).epsilon(0.03));
  CHECK(std::sqrt(pass) == Approx(std::sqrt(0.64 + 0.36 / 3.0)).epsilon(0.1));
}

TEST_CASE("one run tells nothing of repeatability") {
  MeasurementSet set;
  for (int i = 0; i < 20; ++i) {
    Reading one;
    one.position_mm[0] = i;
    set.readings.push_back(one);
  }
  CHECK_FALSE(repeatability_of(set, groups_of(set).front()));
}

}  // namespace
}  // namespace ecs::laser
