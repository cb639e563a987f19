// Whether runs agree: drift from run to run and single runs apart, told from the scatter of the readings.
#include "laser/analysis/run_drift.hpp"

#include <random>

#include "base/random.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// Runs there and back over ten targets with scatter of 0.3 um; `offset` is added to every reading of a run.
template <class Offset>
MeasurementSet runs_with(int runs, unsigned seed, Offset offset) {
  std::mt19937 random(seed);
  NormalDraws scatter(0.0, 0.3);
  MeasurementSet set;
  for (int run = 1; run <= runs; ++run)
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (int target = 0; target < 10; ++target)
        set.readings.push_back(
            reading(Axis::X, Sense::EX, 50.0 * target, 0.1 * target + offset(run) + scatter(random), approach, run));
  return set;
}

RunDrift drift_of(const MeasurementSet& set) { return must(run_drift_of(set, groups_of(set).front())); }

}  // namespace

TEST_CASE("runs of scatter alone neither drift nor stand apart") {
  int told = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const RunDrift drift = drift_of(runs_with(5, seed, [](int) { return 0.0; }));
    told += drift.drifts || !drift.apart.empty() ? 1 : 0;
  }
  CHECK(told <= 1);
}

TEST_CASE("a drift from run to run is measured") {
  const RunDrift drift = drift_of(runs_with(6, 7, [](int run) { return 0.5 * run; }));
  CHECK(drift.drifts);
  CHECK(drift.per_run == Approx(0.5).epsilon(0.1));
  CHECK(drift.first_to_last == Approx(2.5).epsilon(0.1));
  CHECK(drift.apart.empty());
}

TEST_CASE("one run apart from the others is named, and is no drift") {
  const RunDrift drift = drift_of(runs_with(5, 3, [](int run) { return run == 3 ? 2.0 : 0.0; }));
  CHECK(drift.apart == std::vector<int>{3});
  CHECK_FALSE(drift.drifts);
}

TEST_CASE("two runs, and runs of a few readings, say nothing") {
  const MeasurementSet two = runs_with(2, 1, [](int run) { return 5.0 * run; });
  CHECK_FALSE(run_drift_of(two, groups_of(two).front()).has_value());
  MeasurementSet few;
  for (int run = 1; run <= 5; ++run)
    few.readings.push_back(reading(Axis::X, Sense::EX, 0.0, run, Approach::forward, run));
  CHECK_FALSE(run_drift_of(few, groups_of(few).front()).has_value());
}
