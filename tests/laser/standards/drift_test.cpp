// Drift over time (ISO 230-3) against curves whose ranges a hand can compute.
#include "laser/standards/drift.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;
using doctest::Approx;

namespace {

/// A reading each minute over 8 h: 3 um/h for two hours, then nothing, and 6 um/h over the last hour.
MeasurementSet eight_hours() {
  MeasurementSet set;
  set.source = "etve.csv";
  for (int minute = 0; minute <= 480; ++minute) {
    const double hour = minute / 60.0;
    Reading reading;
    reading.time_s = 100.0 + 60.0 * minute;
    reading.error = 5.0 + 3.0 * std::min(hour, 2.0) - 6.0 * std::max(hour - 7.0, 0.0);
    reading.sensors_degC["t_air_degC"] = 20.0 + 0.1 * hour;
    set.readings.push_back(reading);
  }
  return set;
}

std::string drift_refusal(const MeasurementSet& set, double window_h = 1.0) {
  const auto test = drift_test_of(set, window_h);
  REQUIRE(!test);
  return to_text(test.error());
}

}  // namespace

TEST_CASE("the whole range, that of the worst hour and that of the last") {
  const auto test = drift_test_of(eight_hours(), 1.0);
  REQUIRE(test);
  REQUIRE(test->senses.size() == 1);
  const Drift& drift = test->senses.front();
  CHECK(drift.hours == Approx(8.0));
  CHECK(drift.range == Approx(6.0));
  CHECK(drift.window_range == Approx(6.0));
  CHECK(drift.window_from_h == Approx(7.0));
  CHECK(drift.last_window_range == Approx(6.0));
  CHECK(drift.value.front() == 0.0);
  const auto short_windows = drift_test_of(eight_hours(), 0.5);
  REQUIRE(short_windows);
  CHECK(short_windows->senses.front().window_range == Approx(3.0));
  REQUIRE(test->sensors.size() == 1);
  CHECK(test->sensors.front().degC.back() == Approx(20.8));
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
  CHECK(contains(drift_refusal(set), "EX: expected readings at one place over time, found several places"));
}
