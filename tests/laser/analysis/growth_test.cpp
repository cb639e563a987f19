// Growth at one target against temperatures: its coefficient and the lag, whichever of the two is late.
#include "laser/analysis/growth.hpp"

#include <random>

#include "base/file.hpp"
#include "base/random.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// 2 h, a reading every 20 s. A spindle warms by 10 degC with a time constant of 1200 s from minute 10 on and cools
/// from minute 70 on; growth of 6 um/degC of a body that lags behind it, noise 0.3 um.
MeasurementSet warmed(double growth_lag_s, double sensor_lag_s) {
  std::mt19937 random(11);
  NormalDraws noise(0.0, 0.3);
  MeasurementSet set;
  double spindle = 20.0, body = 20.0, sensor = 20.0;
  for (int second = 0; second <= 7200; ++second) {
    spindle += ((second > 600 && second < 4200 ? 30.0 : 20.0) - spindle) / 1200.0;
    body = growth_lag_s > 0.0 ? body + (spindle - body) / growth_lag_s : spindle;
    sensor = sensor_lag_s > 0.0 ? sensor + (spindle - sensor) / sensor_lag_s : spindle;
    if (second % 20 != 0) continue;
    set.readings.push_back(reading(Axis::Z, Sense::EZ, 150.0, 6.0 * (body - 20.0) + noise(random)));
    set.readings.back().time_s = second;
    set.readings.back().sensors_degC["t_spindle_degC"] = sensor;
    set.readings.back().sensors_degC["t_air_degC"] = 20.0 + 0.1 * std::sin(second / 300.0);
  }
  return set;
}

Growth growth_in(const MeasurementSet& set) { return must(growth_of(set, groups_of(set).front())); }

}  // namespace

TEST_CASE("growth that follows a sensor later: coefficient and lag") {
  const Growth growth = growth_in(warmed(600.0, 0.0));
  CHECK(growth.hours == Approx(2.0));
  REQUIRE(growth.sensors.size() == 2);
  CHECK(growth.sensors[0].sensor == "t_spindle_degC");
  CHECK(growth.sensors[0].per_degC == Approx(6.0).epsilon(0.02));
  CHECK(growth.sensors[0].lag_s == Approx(600.0).epsilon(0.1));
  CHECK(growth.sensors[0].explained > 0.99);
  CHECK(growth.sensors[0].rms_left < 0.5);
}

TEST_CASE("a sensor that lags behind the growth has a negative lag") {
  const Growth growth = growth_in(warmed(0.0, 400.0));
  CHECK(growth.sensors[0].lag_s == Approx(-400.0).epsilon(0.1));
  CHECK(growth.sensors[0].per_degC == Approx(6.0).epsilon(0.02));
}

TEST_CASE("runs whose time begins again are no mixture: the lag is sought inside each") {
  for (const bool numbered : {true, false}) {
    MeasurementSet set;
    for (int run = 1; run <= 3; ++run)
      for (Reading reading : warmed(600.0, 0.0).readings) {
        if (numbered) reading.run = run;
        reading.error += 0.1 * run;
        set.readings.push_back(reading);
      }
    const Growth growth = growth_in(set);
    CHECK(growth.stretches == 3);
    CHECK(growth.hours == Approx(2.0));
    CHECK(growth.sensors[0].per_degC == Approx(6.0).epsilon(0.02));
    CHECK(growth.sensors[0].lag_s == Approx(600.0).epsilon(0.1));
    CHECK(growth.sensors[0].rms_left < 0.5);
  }
}

TEST_CASE("runs that follow each other in time are one stretch, in whatever order their rows are") {
  MeasurementSet set = warmed(600.0, 0.0);
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].run = i < 100 ? 1 : 2;
  const Growth growth = growth_in(set);
  CHECK(growth.stretches == 1);
  CHECK(growth.sensors[0].lag_s == Approx(600.0).epsilon(0.1));
  std::mt19937 random(3);
  shuffle(set.readings, random);
  for (Reading& reading : set.readings) reading.run = 1;
  CHECK(growth_in(set).stretches == 1);
  CHECK(growth_in(set).sensors[0].lag_s == Approx(growth.sensors[0].lag_s));
}

TEST_CASE("two readings at one time do not add up in a lag") {
  MeasurementSet set;
  for (const Reading& reading : warmed(600.0, 0.0).readings)
    for (const double off : {3.0, -3.0}) {
      set.readings.push_back(reading);
      set.readings.back().error += off;
      set.readings.back().sensors_degC["t_spindle_degC"] += off;
    }
  for (const SensorGrowth& sensor : growth_in(set).sensors) CHECK(sensor.rms_left < 30.0);
}

TEST_CASE("several targets, or readings without times, are no growth at one target") {
  MeasurementSet set = warmed(0.0, 0.0);
  set.readings[5].position_mm[2] = 151.0;
  CHECK_FALSE(growth_of(set, groups_of(set).front()).has_value());
  MeasurementSet untimed = warmed(0.0, 0.0);
  untimed.readings[5].time_s.reset();
  CHECK_FALSE(growth_of(untimed, groups_of(untimed).front()).has_value());
}

TEST_CASE("six warm-ups with clocks of their own, as a file has them: the lag is that of one warm-up") {
  const auto text = must(read_file("tests/data/made_up/runs_from_zero.csv"));
  const auto set = must(parse_measurement_set(text, "runs_from_zero.csv"));
  const Growth growth = growth_in(set);
  CHECK(growth.stretches == 6);
  CHECK(std::abs(only(growth.sensors).lag_s) < 600.0);  // 2080 s where the six are taken as one
  CHECK(growth.sensors[0].rms_left < 0.1 * growth.range);
}
