// Drift over time and distortion by a moving axis (ISO 230-3) against curves whose ranges a hand can compute.
#include "modules/standards/warm_up.hpp"

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// A reading each minute over 8 h: 3 um/h for two hours, then nothing, and 6 um/h over the last hour.
MeasurementSet eight_hours() {
  MeasurementSet set;
  set.source = "etve.csv";
  for (int minute = 0; minute <= 480; ++minute) {
    const double hour = minute / 60.0;
    Reading reading{.error = 5.0 + 3.0 * std::min(hour, 2.0) - 6.0 * std::max(hour - 7.0, 0.0),
                    .time_s = 100.0 + 60.0 * minute};
    reading.sensors_degC["t_air_degC"] = 20.0 + 0.1 * hour;
    set.readings.push_back(reading);
  }
  return set;
}

std::string drift_refusal(const MeasurementSet& set, double window_h = 1.0) {
  return to_text(must_fail(drift_test_of(set, window_h)));
}

}  // namespace

TEST_CASE("the whole range, that of the worst hour and that of the last") {
  const auto test = must(drift_test_of(eight_hours(), 1.0));
  REQUIRE(test.senses.size() == 1);
  const Drift& drift = test.senses.front();
  CHECK(drift.hours == Approx(8.0));
  CHECK(drift.range == Approx(6.0));
  CHECK(drift.window_range == Approx(6.0));
  CHECK(drift.window_from_h == Approx(7.0));
  CHECK(drift.last_window_range == Approx(6.0));
  CHECK(drift.value.front() == 0.0);
  CHECK(must(drift_test_of(eight_hours(), 0.5)).senses.front().window_range == Approx(3.0));
  CHECK(only(test.sensors).degC.back() == Approx(20.8));
}

TEST_CASE("what a drift test lacks is said in words") {
  MeasurementSet set = eight_hours();
  CHECK(contains(drift_refusal(set, 5.0), "EX: expected a test of 10.00 h or more, twice the window, found 8.00 h"));
  set.readings[7].time_s.reset();
  CHECK(contains(drift_refusal(set), "time_s: expected the time of each reading, found none"));
  set = eight_hours();
  set.readings.resize(5);
  CHECK(contains(drift_refusal(set), "EX: expected 10 readings or more, found 5"));
  set = eight_hours();
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].position_mm[0] = i % 2 == 0 ? 0.0 : 100.0;
  CHECK(contains(drift_refusal(set), "EX: expected readings at one position over time, found several positions"));
}

namespace {

/// Both ends of 1 m every 5 minutes for `hours`: 4 um (1 − e^(−t/0.8 h)) at 0, 24 um at 1000 mm, and a wave of 0.1 um.
MeasurementSet warming_axis(double hours = 4.0) {
  MeasurementSet set;
  set.source = "warm_up.csv";
  for (int i = 0; i * 5 <= hours * 60.0; ++i)
    for (const double position_mm : {0.0, 1000.0}) {
      const double time_h = i / 12.0 + (position_mm > 0.0 ? 1.0 / 120.0 : 0.0);
      Reading reading;
      reading.time_s = 500.0 + 3600.0 * time_h;
      reading.position_mm[0] = position_mm;
      reading.approach = position_mm > 0.0 ? Approach::forward : Approach::reverse;
      reading.error = (4.0 + 0.02 * position_mm) * (1.0 - std::exp(-time_h / 0.8)) + 0.1 * ((i * 7) % 5 - 2);
      set.readings.push_back(reading);
    }
  return set;
}

std::string warm_up_refusal(const MeasurementSet& set) { return to_text(must_fail(warm_up_test_of(set, 1.0))); }

}  // namespace

TEST_CASE("each end of a moving axis has its range, its first and its last hour, and its time constant") {
  const auto test = must(warm_up_test_of(warming_axis(), 1.0));
  REQUIRE(test.curves.size() == 2);
  const WarmUpCurve& far = test.curves.back();
  CHECK(far.position_mm == 1000.0);
  CHECK(far.range == Approx(24.0 * (1.0 - std::exp(-5.0))).epsilon(0.03));
  CHECK(far.first_range == Approx(24.0 * (1.0 - std::exp(-1.25))).epsilon(0.04));
  CHECK(far.last_range == Approx(24.0 * (std::exp(-3.75) - std::exp(-5.0))).epsilon(0.9));
  CHECK(far.settled);
  REQUIRE(far.settling);
  CHECK(std::abs(far.settling->time_constant_h - 0.8) < 3.0 * far.settling->time_constant_uncertainty_h);
  CHECK(std::abs(far.settling->change - 24.0) < 3.0 * far.settling->change_uncertainty + 0.3);
  CHECK(far.settling->to_come == Approx(std::exp(-5.0)).epsilon(0.1));
}

TEST_CASE("a test that is too short has not settled and says how much is to come") {
  const auto test = must(warm_up_test_of(warming_axis(2.0), 1.0));
  const WarmUpCurve& far = test.curves.back();
  CHECK(!far.settled);
  REQUIRE(far.settling);
  CHECK(far.settling->to_come == Approx(std::exp(-2.5)).epsilon(0.2));
}

TEST_CASE("a drift that does not end within the test has no time constant") {
  MeasurementSet set = warming_axis();
  for (Reading& reading : set.readings) reading.error = *reading.time_s / 1000.0 + 0.1 * (reading.position_mm[0] > 0.0);
  const auto test = must(warm_up_test_of(set, 1.0));
  for (const WarmUpCurve& curve : test.curves) {
    CHECK(!curve.settling);
    CHECK(!curve.settled);
  }
}

TEST_CASE("the growth between both ends of one side is told per metre") {
  MeasurementSet set = warming_axis();
  for (Reading& reading : set.readings) reading.approach = Approach::forward;
  const auto test = must(warm_up_test_of(set, 1.0));
  REQUIRE(test.differences.size() == 1);
  const WarmUpDifference& growth = test.differences.front();
  CHECK(growth.to_mm == 1000.0);
  CHECK(growth.range_um_per_m == Approx(20.0 * (1.0 - std::exp(-5.0))).epsilon(0.05));
}

TEST_CASE("what a warm-up test lacks is said in words") {
  CHECK(contains(warm_up_refusal(warming_axis(1.5)),
                 "EX at 0 mm: expected a test of 2.00 h or more, twice the window, found 1.50 h"));
  MeasurementSet set = warming_axis();
  set.readings[3].time_s.reset();
  CHECK(contains(warm_up_refusal(set), "time_s: expected the time of each reading, found none"));
  set = warming_axis();
  for (Reading& reading : set.readings) reading.position_mm[0] = 0.0;
  CHECK(contains(warm_up_refusal(set), "EX: expected two or more positions, found one"));
  set = warming_axis();
  set.readings.back().axis = Axis::Y;
  CHECK(contains(warm_up_refusal(set), "expected readings of one moving axis, found X and Y"));
  set = warming_axis();
  set.readings.resize(8);
  CHECK(contains(warm_up_refusal(set), "EX at 0 mm: expected 10 readings or more, found 4"));
  set = warming_axis();
  set.readings[4].time_s = *set.readings[0].time_s;
  CHECK(contains(warm_up_refusal(set), "EX at 0 mm: expected rising times, found one that does not rise"));
  CHECK(contains(warm_up_refusal(
                     MeasurementSet{.source = "empty.csv", .metadata = {}, .columns = {}, .readings = {}, .notes = {}}),
                 "expected readings, found none"));
}
