#include "model/regression/needs.hpp"

#include <rapidcheck.h>

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// Runs of ten targets; the spindle is as warm as its run says.
Observations with_spindle(const std::vector<double>& degC_of_run, double inside_degC = 0.0) {
  auto set = measured({.targets = 10, .runs = static_cast<int>(degC_of_run.size())}, 0.1, nothing);
  for (Reading& r : set.readings) {
    r.sensors_degC.clear();
    r.sensors_degC["t_spindle_degC"] = degC_of_run[static_cast<std::size_t>(r.run - 1)] + inside_degC * p(r) / 225.0;
  }
  return observations_of(set, straight(), mill());
}

EffectInstance of_spindle(EffectId id) {
  EffectInstance one = effect(id, Axis::X, Sense::EX);
  one.sensor = "t_spindle_degC";
  return one;
}

bool drift_is_tied(const Observations& data) { return is_tied_to_runs(data, of_spindle(thermal_drift)); }

}  // namespace

TEST_CASE("a temperature that changes only from run to run, between two or three levels, is the offset of a run") {
  CHECK(drift_is_tied(with_spindle({20.0, 25.0})));
  CHECK(drift_is_tied(with_spindle({20.0, 25.0, 20.0, 25.0, 20.0})));
  CHECK(drift_is_tied(with_spindle({20.0, 22.0, 24.0})));
  CHECK_FALSE(drift_is_tied(with_spindle({20.0, 22.0, 24.0, 26.0})));
}

TEST_CASE("the number of levels decides, not that of the runs, whatever the levels are") {
  CHECK(rc::check([] {
    const int levels = *rc::gen::inRange(2, 7), runs = levels + *rc::gen::inRange(0, 4);
    const double first = *rc::gen::inRange(150, 250) * 0.1, step = *rc::gen::inRange(2, 50) * 0.1;
    std::vector<double> degC;
    for (int run = 0; run < runs; ++run) degC.push_back(first + step * (run % levels));
    RC_ASSERT(drift_is_tied(with_spindle(degC)) == (levels < 4));
  }));
}

TEST_CASE("what varies inside runs, never varies, or has no runs to coincide with is not tied to them") {
  CHECK_FALSE(drift_is_tied(with_spindle({20.0, 25.0}, 1.0)));
  CHECK(drift_is_tied(with_spindle({20.0, 25.0}, 0.1)));  // a fiftieth of the range: the sensor's noise
  CHECK_FALSE(drift_is_tied(with_spindle({20.0, 20.0, 20.0})));
  CHECK_FALSE(drift_is_tied(with_spindle({20.0})));
}

TEST_CASE("pressure that changes only between runs ties the dead path, not the correction of air along X") {
  auto set = measured({}, 0.1, nothing);
  for (Reading& r : set.readings) {
    r.sensors_degC["t_air_degC"] = 20.0;
    r.humidity_pct = 50.0;
    r.pressure_hPa = r.run == 1 ? 980.0 : 1020.0;
  }
  const Observations between = observations_of(set, straight(), mill());
  for (Reading& r : set.readings) *r.pressure_hPa += 0.02 * p(r);
  const Observations inside = observations_of(set, straight(), mill());
  CHECK(is_tied_to_runs(between, effect(dead_path, Axis::X, Sense::EX)));
  CHECK_FALSE(is_tied_to_runs(inside, effect(dead_path, Axis::X, Sense::EX)));
  CHECK_FALSE(is_tied_to_runs(between, effect(air_refraction, Axis::X, Sense::EX)));
}

TEST_CASE("feed and load are set by people and may coincide with runs") {
  auto set = measured({}, 0.1, nothing);
  for (Reading& r : set.readings) {
    r.feed_mm_min = r.run == 1 ? 500.0 : 4000.0;
    r.load_kg = r.run == 1 ? 0.0 : 200.0;
  }
  const Observations data = observations_of(set, straight(), mill());
  CHECK_FALSE(is_tied_to_runs(data, effect(servo_lag, Axis::X, Sense::EX)));
  CHECK_FALSE(is_tied_to_runs(data, effect(load, Axis::X, Sense::EX)));
}

TEST_CASE("a note names the sensor that follows the runs and what cannot be tried for it") {
  const auto is_told = [](const Observations& data) {
    const std::vector<std::string> notes = untried_effects(data);
    return std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
      return contains(note, "t_spindle_degC changes only from run to run") && contains(note, "thermal_drift");
    });
  };
  CHECK(is_told(with_spindle({20.0, 25.0, 20.0})));
  CHECK_FALSE(is_told(with_spindle({20.0, 22.0, 24.0, 26.0})));
}
