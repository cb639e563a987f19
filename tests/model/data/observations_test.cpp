// Readings as the model takes them: rows given twice.
#include "model/data/observations.hpp"

#include "model/fit/model_file.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

/// Five targets, each of them read `times` times; a reading in whole micrometres.
laser::MeasurementSet rounded_set(int times, bool with_time) {
  laser::MeasurementSet set;
  for (int repeat = 0; repeat < times; ++repeat)
    for (int target = 0; target < 5; ++target) {
      laser::Reading reading;
      reading.position_mm[0] = 100.0 * target;
      reading.error = target;
      reading.row = static_cast<int>(set.readings.size()) + 1;
      if (with_time) reading.time_s = 10.0 * target;
      set.readings.push_back(reading);
    }
  return set;
}

Observations counted(const laser::MeasurementSet& set) { return observations_of(set, Model{}, std::nullopt); }

}  // namespace

TEST_CASE("rows given twice count once, and that is said") {
  const Observations twice = counted(rounded_set(2, true));
  CHECK(twice.size() == 5);
  REQUIRE_FALSE(twice.notes.empty());
  CHECK(twice.notes.back() == "5 rows are identical to another row: each counts once");
  CHECK(counted(rounded_set(3, false)).size() == 5);
  CHECK(counted(rounded_set(1, true)).size() == 5);
}

TEST_CASE("repeats that are equal by chance stay where there are no times") {
  laser::MeasurementSet set = rounded_set(2, false);
  set.readings.back().error = 9.0;  // one repeat differs
  CHECK(counted(set).size() == 10);
}

TEST_CASE("a plan without readings keeps its repeats") {
  laser::MeasurementSet plan = rounded_set(2, false);
  for (laser::Reading& reading : plan.readings) reading.error = 0.0;
  CHECK(counted(plan).size() == 10);
}

TEST_CASE("readings at one place of a pass stay as they follow each other in the file, also where rows are equal") {
  laser::MeasurementSet set;
  for (const double error : {3.0, 1.0, 2.0, 1.0, 3.0}) {
    laser::Reading reading;
    reading.position_mm[0] = 100.0;
    reading.error = error;
    reading.row = static_cast<int>(set.readings.size()) + 1;
    set.readings.push_back(reading);
  }
  CHECK(counted(set).reading == Column{3.0, 1.0, 2.0, 1.0, 3.0});
  for (laser::Reading& reading : set.readings) reading.time_s = 0.0;
  CHECK(counted(set).reading == Column{3.0, 1.0, 2.0});
}
