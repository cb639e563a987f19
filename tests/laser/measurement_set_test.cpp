// The CSV form of measurement sets: what is read, what is refused and where.
#include "laser/measurement_set.hpp"

#include <doctest/doctest.h>

#include "base/text.hpp"
#include "laser/writers/measurement_writer.hpp"
#include "tests/support/readings.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

Problem refusal_of(const std::string& text) {
  const auto set = parse_measurement_set(text, "m.csv");
  REQUIRE_FALSE(set.has_value());
  return set.error();
}

}  // namespace

TEST_CASE("a measurement file gives its metadata, rows and places in order") {
  const auto set = read_measurement_set(sample("x_axis.csv"));
  REQUIRE(set.has_value());
  CHECK(metadata_value(*set, "machine") == "moving column mill");
  REQUIRE(set->readings.size() == 8);
  const Reading& second = set->readings[1];
  CHECK(second.row == 2);
  CHECK(second.line == 5);
  CHECK(second.axis == Axis::X);
  CHECK(second.position_mm == Vector3{-100.0, -1400.0, 0.0});
  CHECK(second.sense == Sense::EX);
  CHECK(second.error == 2.5);
  CHECK(second.approach == Approach::reverse);
  CHECK(second.time_s == 10.0);
  CHECK(second.sensors_degC.at("t_air_degC") == 20.1);
  CHECK(set->readings[3].text_extras.at("operator") == "N, N.");
  CHECK(sensor_names_of(*set) == std::vector<std::string>{"t_air_degC"});
}

TEST_CASE("an empty optional cell is not measured, never a number") {
  const auto set = read_measurement_set(sample("x_axis.csv"));
  REQUIRE(set.has_value());
  CHECK_FALSE(set->readings[2].sensors_degC.contains("t_air_degC"));
  CHECK_FALSE(set->readings[6].text_extras.contains("operator"));
  CHECK_FALSE(set->readings[0].compensated.has_value());
  CHECK_FALSE(set->readings[0].pressure_hPa.has_value());
}

TEST_CASE("absent columns mean position 0, approach unknown and run 1") {
  const auto set = read_measurement_set(sample("minimal.csv"));
  REQUIRE(set.has_value());
  CHECK(set->readings[1].position_mm == Vector3{20.0, 0.0, 0.0});
  CHECK(set->readings[1].approach == Approach::unknown);
  CHECK(set->readings[1].run == 1);
}

TEST_CASE("a moved axis without its position column is read with 0 and a note") {
  const auto set = parse_measurement_set("axis,sense,reading,time_s\nX,EX,1,0\nX,EX,2,5\n", "m.csv");
  REQUIRE(set.has_value());
  CHECK(set->readings[1].position_mm[0] == 0.0);
  CHECK(says(set->notes, "no column x_mm"));
}

TEST_CASE("CRLF, byte order mark, blanks and quotes are accepted") {
  const auto set = read_measurement_set(sample("windows.csv"));
  REQUIRE_MESSAGE(set.has_value(), to_text(set.error()));
  CHECK(metadata_value(*set, "machine") == "Fr\xC3\xA4se 7");
  REQUIRE(set->readings.size() == 2);
  CHECK(set->readings[0].error == 1.5);
  CHECK(set->readings[0].compensated == false);
  CHECK(set->readings[1].error == -0.25);
  CHECK(set->readings[1].approach == Approach::reverse);
}

TEST_CASE("a Windows code page becomes UTF-8 and is noted") {
  const auto set = parse_measurement_set("# machine: Fr\xE4se\naxis,sense,reading,x_mm\nX,EX,1,0\n", "m.csv");
  REQUIRE(set.has_value());
  CHECK(metadata_value(*set, "machine") == "Fr\xC3\xA4se");
  CHECK(says(set->notes, "Windows-1252"));
}

TEST_CASE("every bad row is reported at once with line, column, expectation and finding") {
  const auto set = read_measurement_set(sample("broken_rows.csv"));
  REQUIRE_FALSE(set.has_value());
  const Problem& first = set.error();
  CHECK(first.kind == ProblemKind::bad_input);
  REQUIRE(first.also.size() == 7);
  // rows of another length are found first, then cells
  CHECK(contains(first.message, "expected 6 fields as in the header, found 5"));
  CHECK(first.line == 10);
  struct Expected {
    int line, column;
    const char* message;
  };
  const std::vector<Expected> expected{{3, 1, "axis: expected X, Y, Z, A, B or C, found \"W\""},
                                       {4, 5, "sense: expected EX, EY, EZ (um) or EA, EB, EC (um/m), found \"EQ\""},
                                       {5, 8, "reading: expected a finite number, found \"nan\""},
                                       {6, 12, "approach: expected 1, -1 or 0, found \"2\""},
                                       {7, 14, "run: expected an integer, found \"1.5\""},
                                       {8, 3, "x_mm: expected the target position of the moving axis, found nothing"},
                                       {9, 8, "decimal comma"}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(first.also[i].line == expected[i].line);
    CHECK(first.also[i].column == expected[i].column);
    CHECK_MESSAGE(contains(first.also[i].message, expected[i].message), first.also[i].message);
  }
}

TEST_CASE("after twenty faults the rest is counted") {
  std::string text = "axis,x_mm,sense,reading\n";
  for (int i = 0; i < 25; ++i) text += "X,0,EX,oops\n";
  const Problem refusal = refusal_of(text);
  CHECK(refusal.also.size() == 20);
  CHECK(contains(refusal.also.back().message, "and 5 more"));
}

TEST_CASE("missing columns are named together with what may have been meant") {
  const auto set = read_measurement_set(sample("broken_header.csv"));
  REQUIRE_FALSE(set.has_value());
  const std::string text = to_text(set.error());
  CHECK(contains(text, "expected a column sense, found none; is \"sence\" meant"));
  CHECK(contains(text, "expected a column reading, found none; is \"readng\" meant"));
}

TEST_CASE("a misspelt optional column is kept and noted") {
  const auto set = parse_measurement_set("axis,x_mm,sense,reading,feed_mm_mim\nX,0,EX,1,500\n", "m.csv");
  REQUIRE(set.has_value());
  CHECK(set->readings[0].extras.at("feed_mm_mim") == 500.0);
  CHECK(says(set->notes, "is feed_mm_min meant"));
}

TEST_CASE("semicolons or tabs between the fields come with decimal commas") {
  const auto set = read_measurement_set(sample("semicolon.csv"));
  REQUIRE_MESSAGE(set.has_value(), to_text(set.error()));
  REQUIRE(set->readings.size() == 1);
  CHECK(set->readings[0].error == 1.5);
  CHECK(says(set->notes, "semicolons"));
  const auto tabs = parse_measurement_set("axis\tx_mm\tsense\treading\tapproach\nX\t0,5\tEX\t1.25\t\n", "m.csv");
  REQUIRE(tabs.has_value());
  CHECK(tabs->readings[0].position_mm[0] == 0.5);
  CHECK(tabs->readings[0].error == 1.25);
}

TEST_CASE("UTF-16 is read with and without its mark") {
  const std::string plain = "axis,x_mm,sense,reading\nX,0,EX,1.5\n";
  for (const bool big : {false, true})
    for (const bool marked : {false, true}) {
      std::string bytes = !marked ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
      for (const char c : plain) bytes += big ? std::string{'\0', c} : std::string{c, '\0'};
      const auto set = parse_measurement_set(bytes, "m.csv");
      REQUIRE_MESSAGE(set.has_value(), to_text(set.error()));
      CHECK(set->readings[0].error == 1.5);
      CHECK(says(set->notes, "UTF-16"));
    }
}

TEST_CASE("duplicate columns, empty and binary files are refused by name") {
  CHECK(contains(to_text(read_measurement_set(sample("broken_duplicate.csv")).error()), "expected each column once"));
  CHECK(contains(to_text(read_measurement_set(sample("broken_empty.csv")).error()), "empty file"));
  CHECK(contains(to_text(read_measurement_set(sample("broken_binary.csv")).error()), "binary"));
  CHECK(contains(refusal_of("\xFF\xFE"
                            "a")
                     .message,
                 "UTF-16"));
  CHECK(contains(refusal_of("# only: comments\n").message, "only comments"));
  CHECK(contains(refusal_of("axis,sense,reading\n").message, "expected readings below the header"));
  CHECK(contains(to_text(read_measurement_set(sample("none.csv")).error()), "no such file"));
}

TEST_CASE("infinite numbers, open quotes and late comments are refused") {
  CHECK(contains(refusal_of("axis,sense,reading\nX,EX,inf\n").message, "finite"));
  CHECK(contains(refusal_of("axis,sense,reading\nX,EX,\"1\n").message, "closing double quote"));
  CHECK(refusal_of("axis,sense,reading\nX,EX,\"1\n").column == 6);
  CHECK(contains(refusal_of("axis,sense,reading\nX,EX,1\n# late: x,y\n").message, "before the header"));
  CHECK(contains(refusal_of("axis,sense,reading,compensated\nX,EX,1,2\n").message, "compensated: expected 0 or 1"));
  CHECK(contains(refusal_of("axis,sense,reading,t_air_degC\nX,EX,1,warm\n").message, "t_air_degC: expected a finite"));
}

TEST_CASE("columns count characters, not bytes") {
  CHECK(refusal_of("note,axis,sense,reading\n\xC3\xA4\xC3\xB6,X,EX,oops\n").column == 9);
}

TEST_CASE("a column with one word among numbers stays text as a whole") {
  const auto set = parse_measurement_set("axis,sense,reading,probe,count\nX,EX,1,7,7\nX,EX,1,left,8\n", "m.csv");
  REQUIRE(set.has_value());
  CHECK(set->readings[0].text_extras.at("probe") == "7");
  CHECK(set->readings[0].extras.at("count") == 7.0);
}

TEST_CASE("writing gives back the rows of every good sample") {
  for (const char* const name : {"x_axis.csv", "minimal.csv", "windows.csv"}) {
    const auto set = read_measurement_set(sample(name));
    REQUIRE(set.has_value());
    auto again = parse_measurement_set(to_csv(*set), set->source);
    REQUIRE_MESSAGE(again.has_value(), name);
    CHECK(again->metadata == set->metadata);
    CHECK(again->columns == set->columns);
    CHECK(again->readings == set->readings);
  }
}

TEST_CASE("a set made in memory is written with the columns it needs") {
  MeasurementSet set;
  set.metadata = {{"machine", "mill"}};
  set.readings = {reading(Axis::Y, Sense::EC, -0.1, 2.5, Approach::forward, 3)};
  set.readings[0].load_kg = 120.0;
  set.readings[0].sensors_degC["t_spindle_degC"] = 31.5;
  set.readings[0].compensated = true;
  CHECK(to_csv(set) ==
        "# machine: mill\n"
        "axis,x_mm,y_mm,z_mm,sense,reading,approach,run,load_kg,compensated,t_spindle_degC\n"
        "Y,0,-0.1,0,EC,2.5,1,3,120,1,31.5\n");
}
