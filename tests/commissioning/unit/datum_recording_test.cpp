// Recorded datum sequences as files and as events.
#include "commissioning/unit/datum_recording.hpp"

#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

/// Half a second of standing, then 1 um each ms (60 mm/min), switch closed from 1.0 to 1.2 s, marker at 1.4 s.
DatumRecording approach() {
  DatumRecording r{.axis = Axis::Y, .taken = "2026-05-04T09:30:00Z", .serial_number = "MCM-0107"};
  for (int ms = 0; ms < 2000; ++ms) r.samples.push_back({ms < 500 ? 0 : ms - 500, ms >= 1000 && ms < 1200, ms == 1400});
  return r;
}

TEST_CASE("the speed is the slope of the position") {
  const auto speeds = speeds_mm_min(approach());
  CHECK(speeds[250] == Approx(0.0));
  CHECK(speeds[1000] == Approx(60.0));
  CHECK(speeds[1999] == Approx(60.0));
}

TEST_CASE("events are listed in order with time and position") {
  const auto events = events_of(approach());
  REQUIRE(events.size() == 4);
  CHECK(events[0].what == "motion begins");
  CHECK(events[0].time_s == Approx(0.5).epsilon(0.05));
  CHECK(events[1].what == "switch closes");
  CHECK(events[1].time_s == Approx(1.0));
  CHECK(events[1].position_mm == Approx(0.5));
  CHECK(events[2].what == "switch opens");
  CHECK(events[3].what == "marker");
  CHECK(events[3].position_mm == Approx(0.9));
}

TEST_CASE("a record written and read back is the same") {
  const DatumRecording before = approach();
  const auto after = must(parse_recording(to_csv(before), "r.csv"));
  CHECK(after.samples == before.samples);
  CHECK(after.axis == before.axis);
  CHECK(after.um_per_count == before.um_per_count);
  CHECK(after.sample_period_us == before.sample_period_us);
  CHECK(after.serial_number == before.serial_number);
}

TEST_CASE("a unit that states a period of almost nothing gives speeds all the same") {
  DatumRecording recording = approach();
  recording.sample_period_us = 1e-300;
  CHECK(speeds_mm_min(recording).size() == recording.samples.size());
}

}  // namespace
}  // namespace ecs::commissioning
