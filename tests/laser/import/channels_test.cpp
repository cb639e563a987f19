// Logs of several channels joined by time: JSON lines and the lines of a control system; readings at rest.
#include "laser/import/channels.hpp"

#include <fmt/format.h>

#include "laser/import/format.hpp"
#include "laser/import/set_up.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

ImportOptions by_channels(const std::string& channels) {
  ImportOptions options;
  options.channels = column_mapping(channels).value();
  return options;
}

MeasurementSet read_lines(const std::string& text, const ImportOptions& options) {
  const auto read = must(parse_any(text, "log.jsonl", options));
  CHECK(read.format->id == "json_lines");
  return read.set;
}

/// z every 2 s, a bed of 20 + t/10 degC every 4 s.
std::string probe_log() {
  std::string text;
  for (int t = 0; t <= 20; t += 2) text += fmt::format("{{\"ts\": {}.0, \"z\": {}}}\n", 1000 + t, 0.001 * t);
  for (int t = 0; t <= 20; t += 4)
    text += fmt::format("{{\"ts\": {}.0, \"bed\": {{\"temp\": {}}}, \"set\": null}}\n", 1000 + t, 20.0 + 0.1 * t);
  return text;
}

}  // namespace

TEST_CASE("JSON lines: channels are joined by time, linear between their values") {
  ImportOptions options = by_channels("EZ=z[mm],t_bed_degC=bed.temp");
  options.axis = Axis::Z;
  options.parked_mm = {0.0, 0.0, 150.0};
  const auto set = read_lines(probe_log(), options);
  REQUIRE(set.readings.size() == 11);
  CHECK(set.readings[1].error == Approx(2.0));
  CHECK(set.readings[1].sensors_degC.at("t_bed_degC") == Approx(20.2));
  CHECK(*set.readings[1].time_s == Approx(2.0));
  CHECK(set.readings[1].position_mm[2] == 150.0);  // one target all the time
  CHECK(
      says(set.notes, "bed.temp: joined by time, linear between its values; largest gap 4 s (--max-gap allows 20 s)"));
}

TEST_CASE("the nearest value and the value before are other ways to join") {
  ImportOptions options = by_channels("EZ=z[mm],t_bed_degC=bed.temp");
  options.axis = Axis::Z;
  options.joining = Joining::previous;
  CHECK(read_lines(probe_log(), options).readings[3].sensors_degC.at("t_bed_degC") == Approx(20.4));
  options.joining = Joining::nearest;
  options.greatest_gap_s = 1.0;
  const auto set = read_lines(probe_log(), options);
  CHECK_FALSE(set.readings[1].sensors_degC.contains("t_bed_degC"));  // 2 s away
  CHECK(set.readings[2].sensors_degC.contains("t_bed_degC"));
}

TEST_CASE("rows without a position within the greatest gap are left out and counted") {
  const std::string text =
      "{\"t\":0,\"pos\":0,\"e\":1}\n{\"t\":1,\"pos\":10}\n{\"t\":1,\"e\":2}\n{\"t\":50,\"e\":3}\n{\"t\":100,\"pos\":20}"
      "\n";
  ImportOptions options = by_channels("x_mm=pos,reading=e[um]");
  options.greatest_gap_s = 5.0;
  const auto set = read_lines(text, options);
  REQUIRE(set.readings.size() == 2);
  CHECK(says(set.notes, "1 values of e without values of the other channels within the largest gap are ignored"));
}

TEST_CASE("channels that bear the names of columns need no options; others are listed") {
  const auto set = read_lines("{\"time_s\":0,\"x_mm\":0,\"EX\":1}\n{\"time_s\":1,\"x_mm\":10,\"EX\":2}\n", {});
  REQUIRE(set.readings.size() == 2);
  CHECK(set.readings[1].position_mm[0] == 10.0);
  const auto refused = must_fail(parse_any(probe_log(), "log.jsonl", {}));
  CHECK(refused.line == 1);
  CHECK(contains(refused.message,
                 "the meaning of the channels is not known (bed.temp (6 values), z (11 values)): give --channels"));
  ImportOptions wrong = by_channels("EZ=zz");
  wrong.axis = Axis::Z;
  const auto unknown = parse_any(probe_log(), "log.jsonl", wrong);
  CHECK(contains(unknown.error().message, "no channel \"zz\" in the log; it has bed.temp"));
}

TEST_CASE("a bad JSON line is refused with line and column") {
  const auto bad = must_fail(parse_any("{\"t\":0,\"EX\":1}\n{\"t\":1,\"EX\":}\n{\"EX\":2}\n", "log.jsonl", {}));
  CHECK(bad.line == 2);
  CHECK(bad.column == 13);
  CHECK(only(bad.also).line == 3);
  CHECK(contains(bad.also[0].message, "expected a JSON object with its time"));
}

TEST_CASE("several channels of a control system's log as position, reading and temperature") {
  std::string text;
  for (int s = 10; s < 16; ++s) {
    text += fmt::format("ENC 2022-11-08 14:00:{}.0 {}\n", s, s * 2.0);
    text += fmt::format("LASER 2022-11-08 14:00:{}.5 {}\n", s, s * 2.0 + 1.003);
    text += fmt::format("AIR 2022-11-08 14:00:{}.0 20.{}\n", s, s);
  }
  ImportOptions options = by_columns("date_time=2..3,reading=4");
  options.mapping->row_begins = cell_kinds("word date time any").value();
  options.mapping->channel_column = 1;
  options.mapping->delimiter = ' ';
  options.channels = column_mapping("x_mm=ENC[mm],reading=LASER[mm],t_air_degC=AIR").value();
  options.channels->values = TableValues::actual_positions;
  const auto read = must(parse_any(text, "pv.log", options));
  REQUIRE(read.set.readings.size() == 5);  // after the last value of ENC there is nothing to join
  CHECK(read.set.readings[0].position_mm[0] == Approx(21.0));
  CHECK(read.set.readings[0].error == Approx(3.0));
  CHECK(read.set.readings[0].sensors_degC.at("t_air_degC") == Approx(20.105));
  CHECK(metadata_value(read.set, "begun") == "2022-11-08 14:00:10.500");
}

TEST_CASE("rows at rest only, and their means") {
  MeasurementSet set;
  int row = 0;
  for (const auto& [position, error] : std::vector<std::pair<double, double>>{{0.0, 1.0},
                                                                              {0.001, 2.0},
                                                                              {0.0, 3.0},
                                                                              {4.0, 50.0},
                                                                              {7.0, 60.0},
                                                                              {10.0, 4.0},
                                                                              {10.001, 5.0},
                                                                              {10.0, 6.0},
                                                                              {10.0, 7.0}}) {
    set.readings.push_back(reading(Axis::X, Sense::EX, position, error));
    set.readings.back().row = ++row;
    set.readings.back().sensors_degC["t_air_degC"] = 20.0 + row;
  }
  MeasurementSet averaged = set;
  keep_at_rest(set, 0.01, false);
  CHECK(set.readings.size() == 7);
  CHECK(says(set.notes, "2 readings during motion are ignored"));
  keep_at_rest(averaged, 0.01, true);
  REQUIRE(averaged.readings.size() == 2);
  CHECK(averaged.readings[0].error == Approx(2.0));
  CHECK(averaged.readings[1].error == Approx(5.5));
  CHECK(averaged.readings[1].position_mm[0] == Approx(10.00025));
  CHECK(averaged.readings[1].extras.at("readings_averaged") == 4.0);
  CHECK(averaged.readings[0].extras.at("scatter") == Approx(1.0));
  CHECK(averaged.readings[0].sensors_degC.at("t_air_degC") == Approx(22.0));
  CHECK(says(averaged.notes, "7 readings at rest averaged to 2"));
}
