// Environment logs: tables by their headings, and both kinds joined to readings by time.
#include "laser/import/environment.hpp"

#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

EnvironmentSeries series_of(const std::string& text) {
  const auto read = must(parse_any(text, "env.csv", {}));
  CHECK(read.format->id == "environment_table");
  return read.environment;
}

MeasurementSet four_readings() {
  MeasurementSet set;
  for (int i = 0; i < 4; ++i) {
    set.readings.push_back(reading(Axis::X, Sense::EX, 10.0 * i, 0.0));
    set.readings.back().time_s = 10.0 * i;
  }
  return set;
}

}  // namespace

TEST_CASE("a table of the environment is read by its headings and units") {
  const auto series = series_of(
      "time (min),air temperature (°F),part temperature (°C),Pressure (kPa),rel. humidity (%)\n"
      "0,68,20.5,99.1,45\n5,77,,99.2,46\n");
  REQUIRE(series.rows.size() == 2);
  CHECK(*series.rows[1].time_s == Approx(300.0));
  CHECK(*series.value(1, "t_air_degC") == Approx(25.0));
  CHECK_FALSE(series.value(1, "t_part_degC").has_value());
  CHECK(*series.value(0, "pressure_hPa") == Approx(991.0));
  CHECK(*series.value(1, "humidity_pct") == 46.0);
}

TEST_CASE("a bad cell of an environment table is refused with line and column") {
  const auto read = must_fail(parse_any("air temperature,pressure\n20.1,991\n20.2,?\n", "env.csv", {}));
  CHECK(read.line == 3);
  CHECK(read.column == 6);
}

TEST_CASE("the environment is joined by time, linear, its end values beyond its ends") {
  MeasurementSet set = four_readings();
  set.readings[2].sensors_degC["t_air_degC"] = 30.0;
  (void)must(
      join_environment(set, series_of("time_s,t_air_degC,pressure_hPa\n100,20,990\n120,22,992\n"), std::nullopt));
  CHECK(set.readings[1].sensors_degC.at("t_air_degC") == Approx(21.0));
  CHECK(set.readings[2].sensors_degC.at("t_air_degC") == 30.0);  // its own
  CHECK(*set.readings[3].pressure_hPa == Approx(992.0));
  CHECK(says(set.notes, "assumed to begin with the first reading"));
  CHECK(says(set.notes, "extend 10 s after it ends"));
  CHECK(says(set.notes, "t_air_degC 20 ... 22"));
}

TEST_CASE("dates on both sides meet") {
  MeasurementSet set = four_readings();
  set.metadata.push_back({"begun", "2024-05-06 09:00:00.000"});
  REQUIRE(join_environment(set,
                           series_of("date,air temperature (°C),humidity (%)\n2024-05-06 08:59:50,20,40\n"
                                     "2024-05-06 09:00:30,24,44\n"),
                           std::nullopt));
  CHECK(set.readings[0].sensors_degC.at("t_air_degC") == Approx(21.0));
  CHECK(*set.readings[3].humidity_pct == Approx(44.0));
  CHECK(says(set.notes, "joined by date and time"));
}

TEST_CASE("a log without times is spread over the readings, or has a row every this many seconds") {
  const auto log = must(read_any("samples/laser/environment.pos"));
  MeasurementSet set = four_readings();
  REQUIRE(join_environment(set, log.environment, std::nullopt));
  CHECK(says(set.notes, "its 2 rows are distributed evenly over the time of the readings"));
  CHECK(*set.readings[3].pressure_hPa == Approx(*log.environment.value(1, "pressure_hPa")));
  MeasurementSet timed = four_readings();
  REQUIRE(join_environment(timed, log.environment, 10.0));
  CHECK(*timed.readings[1].pressure_hPa == Approx(*log.environment.value(1, "pressure_hPa")));
  MeasurementSet untimed = four_readings();
  for (Reading& one : untimed.readings) one.time_s.reset();
  CHECK(join_environment(untimed, log.environment, 10.0).error().kind == ProblemKind::usage);
}
