// The CSV form of measurement sets: what is read, what is refused and where; its properties over arbitrary sets; which
// machine a file was measured on.
#include "laser/measurement_set.hpp"

#include <rapidcheck.h>

#include "base/text.hpp"
#include "laser/writers/writers.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

Problem refusal_of(const std::string& text) { return must_fail(parse_measurement_set(text, "m.csv")); }

}  // namespace

TEST_CASE("a measurement file gives its metadata, rows and places in order") {
  const auto set = must(read_measurement_set(sample("x_axis.csv")));
  CHECK(metadata_value(set, "machine") == "moving column mill");
  REQUIRE(set.readings.size() == 8);
  const Reading& second = set.readings[1];
  CHECK(second.row == 2);
  CHECK(second.line == 5);
  CHECK(second.axis == Axis::X);
  CHECK(second.position_mm == Vector3{-100.0, -1400.0, 0.0});
  CHECK(second.sense == Sense::EX);
  CHECK(second.error == 2.5);
  CHECK(second.approach == Approach::reverse);
  CHECK(second.time_s == 10.0);
  CHECK(second.sensors_degC.at("t_air_degC") == 20.1);
  CHECK(set.readings[3].text_extras.at("operator") == "N, N.");
  CHECK(sensor_names_of(set) == std::vector<std::string>{"t_air_degC"});
}

TEST_CASE("an empty optional cell is not measured, never a number") {
  const auto set = must(read_measurement_set(sample("x_axis.csv")));
  CHECK_FALSE(set.readings[2].sensors_degC.contains("t_air_degC"));
  CHECK_FALSE(set.readings[6].text_extras.contains("operator"));
  CHECK_FALSE(set.readings[0].compensated.has_value());
  CHECK_FALSE(set.readings[0].pressure_hPa.has_value());
}

TEST_CASE("absent columns mean position 0, approach unknown and run 1") {
  const auto set = must(read_measurement_set(sample("minimal.csv")));
  CHECK(set.readings[1].position_mm == Vector3{20.0, 0.0, 0.0});
  CHECK(set.readings[1].approach == Approach::unknown);
  CHECK(set.readings[1].run == 1);
}

TEST_CASE("a moved axis without its position column is read with 0 and a note") {
  const auto set = must(parse_measurement_set("axis,sense,reading,time_s\nX,EX,1,0\nX,EX,2,5\n", "m.csv"));
  CHECK(set.readings[1].position_mm[0] == 0.0);
  CHECK(says(set.notes, "no column x_mm"));
}

TEST_CASE("CRLF, byte order mark, blanks and quotes are accepted") {
  const auto set = must(read_measurement_set(sample("windows.csv")));
  CHECK(metadata_value(set, "machine") == "Fr\xC3\xA4se 7");
  REQUIRE(set.readings.size() == 2);
  CHECK(set.readings[0].error == 1.5);
  CHECK(set.readings[0].compensated == false);
  CHECK(set.readings[1].error == -0.25);
  CHECK(set.readings[1].approach == Approach::reverse);
}

TEST_CASE("a Windows code page becomes UTF-8 and is noted") {
  const auto set = must(parse_measurement_set("# machine: Fr\xE4se\naxis,sense,reading,x_mm\nX,EX,1,0\n", "m.csv"));
  CHECK(metadata_value(set, "machine") == "Fr\xC3\xA4se");
  CHECK(says(set.notes, "Windows-1252"));
}

TEST_CASE("every bad row is reported at once with line, column, expectation and finding") {
  const auto set = must_fail(read_measurement_set(sample("broken_rows.csv")));
  const Problem& first = set;
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
                                       {6, 12, "approach: expected 1, -1, 0, forward or reverse, found \"2\""},
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
  const std::string text = to_text(must_fail(read_measurement_set(sample("broken_header.csv"))));
  check_holds(text, {"expected a column sense, found none; is \"sence\" meant",
                     "expected a column reading, found none; is \"readng\" meant"});
}

TEST_CASE("a misspelt optional column is kept and noted") {
  const auto set = must(parse_measurement_set("axis,x_mm,sense,reading,feed_mm_mim\nX,0,EX,1,500\n", "m.csv"));
  CHECK(set.readings[0].extras.at("feed_mm_mim") == 500.0);
  CHECK(says(set.notes, "is feed_mm_min meant"));
}

TEST_CASE("semicolons or tabs between the fields come with decimal commas") {
  const auto set = must(read_measurement_set(sample("semicolon.csv")));
  CHECK(only(set.readings).error == 1.5);
  CHECK(says(set.notes, "semicolons"));
  const auto tabs = must(parse_measurement_set("axis\tx_mm\tsense\treading\tapproach\nX\t0,5\tEX\t1.25\t\n", "m.csv"));
  CHECK(tabs.readings[0].position_mm[0] == 0.5);
  CHECK(tabs.readings[0].error == 1.25);
}

TEST_CASE("UTF-16 is read with and without its mark") {
  const std::string plain = "axis,x_mm,sense,reading\nX,0,EX,1.5\n";
  for (const bool big : {false, true})
    for (const bool marked : {false, true}) {
      std::string bytes = !marked ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
      for (const char c : plain) bytes += big ? std::string{'\0', c} : std::string{c, '\0'};
      const auto set = must(parse_measurement_set(bytes, "m.csv"));
      CHECK(set.readings[0].error == 1.5);
      CHECK(says(set.notes, "UTF-16"));
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

TEST_CASE("a standard uncertainty that is no number above 0 is refused with its place, an empty one is not stated") {
  const Problem zero = refusal_of("axis,x_mm,sense,reading,u_um\nX,0,EX,1,0.5\nX,1,EX,1,0\n");
  CHECK(contains(zero.message, "u_um: expected a standard uncertainty above 0, found \"0\""));
  CHECK(zero.line == 3);
  CHECK(zero.column == 10);
  CHECK(contains(refusal_of("axis,x_mm,sense,reading,u_um\nX,0,EX,1,good\n").message, "found \"good\""));
  const auto set = must(parse_measurement_set("axis,x_mm,sense,reading,u_um\nX,0,EX,1,0.5\nX,1,EX,1,\n", "m.csv"));
  CHECK(set.readings[0].extras.at("u_um") == 0.5);
  CHECK_FALSE(set.readings[1].extras.contains("u_um"));
}

TEST_CASE("a column with one word among numbers stays text as a whole") {
  const auto set = must(parse_measurement_set("axis,sense,reading,probe,count\nX,EX,1,7,7\nX,EX,1,left,8\n", "m.csv"));
  CHECK(set.readings[0].text_extras.at("probe") == "7");
  CHECK(set.readings[0].extras.at("count") == 7.0);
}

TEST_CASE("writing gives back the rows of every good sample") {
  for (const char* const name : {"x_axis.csv", "minimal.csv", "windows.csv"}) {
    const auto set = must(read_measurement_set(sample(name)));
    auto again = parse_measurement_set(to_csv(set), set.source);
    REQUIRE_MESSAGE(again.has_value(), name);
    CHECK(again->metadata == set.metadata);
    CHECK(again->columns == set.columns);
    CHECK(again->readings == set.readings);
  }
}

TEST_CASE("a set made in memory is written with the columns it needs") {
  MeasurementSet set{.metadata = {{"machine", "mill"}},
                     .readings = {reading(Axis::Y, Sense::EC, -0.1, 2.5, Approach::forward, 3)}};
  set.readings[0].load_kg = 120.0;
  set.readings[0].sensors_degC["t_spindle_degC"] = 31.5;
  set.readings[0].compensated = true;
  CHECK(to_csv(set) ==
        "# machine: mill\n"
        "axis,x_mm,y_mm,z_mm,sense,reading,approach,run,load_kg,compensated,t_spindle_degC\n"
        "Y,0,-0.1,0,EC,2.5,1,3,120,1,31.5\n");
}

namespace {

/// Approaches in the order of the file.
std::vector<int> approaches_in(const std::string& text, bool order_gives_approach = true) {
  const auto set =
      must(order_gives_approach ? parse_measurement_set(text, "m.csv") : set_with_approach_open(text, "m.csv"));
  std::vector<int> approaches;
  for (const Reading& reading : set.readings) approaches.push_back(static_cast<int>(reading.approach));
  return approaches;
}

/// X to these targets in EX, without a column approach.
std::string to_targets(const std::vector<double>& targets_mm, const std::string& more = "") {
  std::string text = "axis,sense,reading,run,x_mm\n";
  for (const double target_mm : targets_mm) text += "X,EX,5,1," + shortest(target_mm) + "\n";
  return text + more;
}

}  // namespace

TEST_CASE("without a column approach a run that goes both ways has it from the order of its targets, but the first") {
  const std::string text = to_targets({0, 100, 200, 200, 100, 0});
  CHECK(approaches_in(text) == std::vector<int>{0, 1, 1, -1, -1, -1});
  const auto set = must(parse_measurement_set(text, "m.csv"));
  CHECK(contains(set.notes.front(), "no column approach: it is deduced from the order of the targets for 5 of 6"));
  CHECK(contains(to_csv(set), "approach"));
}

TEST_CASE("a next run begins with an unknown approach again") {
  CHECK(approaches_in(to_targets({0, 100, 200, 100, 0}, "X,EX,5,2,0\nX,EX,5,2,100\nX,EX,5,2,0\n")) ==
        std::vector<int>{0, 1, 1, -1, -1, 0, 1, -1});
}

TEST_CASE("passes one way, positions in no order and a place that trembles leave the approach unknown") {
  CHECK(approaches_in(to_targets({0, 100, 200, 300})) == std::vector<int>(4, 0));
  CHECK(approaches_in(to_targets({0, 100, 200, 300, 0, 100, 200, 300})) == std::vector<int>(8, 0));
  CHECK(approaches_in(to_targets({0, 300, 100, 200, 50, 250})) == std::vector<int>(6, 0));
  CHECK(approaches_in(to_targets({100, 100.0002, 99.9999, 100.0001, 99.9998})) == std::vector<int>(5, 0));
}

TEST_CASE("what an encoder reads at a stop again is no motion, and repeats at the turn are parted in two") {
  CHECK(approaches_in(to_targets({0, 0.0001, 100, 99.9999, 200, 200.0001, 200, 199.9999, 100, 100.0001, 0, 0})) ==
        std::vector<int>{0, 0, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1});
  CHECK(approaches_in(to_targets({0, 0, 100, 100, 200, 200, 100, 100, 0, 0})) ==
        std::vector<int>{0, 0, 1, 1, 1, 1, -1, -1, -1, -1});
}

TEST_CASE("an approach that the file states stays, 0 too, and it can be left unknown") {
  CHECK(approaches_in("axis,sense,reading,x_mm,approach\nX,EX,5,0,0\nX,EX,5,9,0\nX,EX,5,0,\n") ==
        std::vector<int>(3, 0));
  const std::string text = to_targets({0, 100, 200, 100, 0});
  CHECK(approaches_in(text, false) == std::vector<int>(5, 0));
  const auto set = must(set_with_approach_open(text, "m.csv"));
  CHECK(approaches_in(to_csv(set)) == std::vector<int>(5, 0));  // written as said
}

TEST_CASE("a measurement CSV knows the words for the approach") {
  const std::vector<std::pair<std::string, int>> words{{"forward", 1}, {"Reverse", -1}, {"fwd", 1}, {"rev", -1},
                                                       {"+", 1},       {"-", -1},       {"up", 1},  {"down", -1}};
  for (const auto& [word, approach] : words)
    CHECK(approaches_in("axis,sense,reading,x_mm,approach\nX,EX,5,0," + word + "\n") == std::vector<int>{approach});
}

TEST_CASE("a circle states its own direction") {
  std::string text = "axis,sense,reading,x_mm,y_mm,path\n";
  for (const char* x : {"0", "50", "100", "50", "0"})
    text += std::string("X,EX,5,") + x + ",0,circle XY radius 50 centre 50 0 0\n";
  CHECK(approaches_in(text) == std::vector<int>(5, 0));
}

TEST_CASE("a target under another name is asked about in place of 0 everywhere") {
  for (const std::string name : {"target_mm", "position_mm", "x", "X_mm", "Soll [mm]", "x_um"}) {
    const Problem refused = refusal_of("axis,sense,reading," + name + "\nX,EX,5,0\nX,EX,6,100\n");
    CHECK(refused.line == 1);
    CHECK_MESSAGE(contains(refused.message, "there is no column x_mm"), refused.message);
    CHECK_MESSAGE(contains(refused.message, "If \"" + name + "\" contains them"), refused.message);
  }
  // an axis that stood still, and columns of another meaning
  CHECK(parse_measurement_set("axis,sense,reading,target_mm\nX,EX,5,100\nX,EX,6,100\n", "m.csv").has_value());
  CHECK(parse_measurement_set("axis,sense,reading,probe\nX,EX,5,1\nX,EX,6,2\n", "m.csv").has_value());
  CHECK(parse_measurement_set("axis,sense,reading,x_mm,target\nX,EX,5,1,7\nX,EX,6,2,8\n", "m.csv").has_value());
}

TEST_CASE("readings and positions that no machine has are refused with line and limit") {
  const Problem refused = refusal_of("axis,sense,reading,x_mm\nX,EX,1e300,0\nX,EX,1,4e9\nX,EA,9e7,1\nX,EX,9e6,-9e5\n");
  CHECK(refused.line == 2);
  CHECK(contains(refused.message, "reading: expected at most 1e+07 um either way, found 1e+300"));
  REQUIRE(refused.also.size() == 2);
  CHECK(refused.also[0].line == 3);
  CHECK(contains(refused.also[0].message, "x_mm: expected at most 1e+06 mm either way, found 4e+09"));
  CHECK(contains(refused.also[1].message, "um/m"));
}

TEST_CASE("readings that are all below 0.1 um are noted as perhaps mm") {
  const auto set =
      must(parse_measurement_set("axis,sense,reading,x_mm\nX,EX,0.025,0\nX,EX,-0.01,50\nX,EX,0.02,99\n", "m.csv"));
  CHECK(says(set.notes, "all readings are below 0.1 um, the largest is 0.025: are they in mm?"));
}

namespace {

double number() {
  return *rc::gen::map(rc::gen::arbitrary<int>(), [](int i) { return i / 9970.0; });  // within what a machine can have
}

std::optional<double> maybe_number() { return *rc::gen::arbitrary<bool>() ? std::optional(number()) : std::nullopt; }

std::string text() {
  return *rc::gen::container<std::string>(rc::gen::element('a', 'Z', ',', '"', ' ', '#', '1', '.'));
}

Reading arbitrary_reading() {
  Reading reading{.axis = *rc::gen::element(Axis::X, Axis::Y, Axis::Z),
                  .position_mm = {number(), number(), number()},
                  .sense = *rc::gen::element(Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC),
                  .error = number(),
                  .approach = *rc::gen::element(Approach::forward, Approach::unknown, Approach::reverse),
                  .run = *rc::gen::inRange(-3, 100),
                  .time_s = maybe_number(),
                  .feed_mm_min = maybe_number(),
                  .load_kg = maybe_number(),
                  .travel_since_reversal_mm = maybe_number(),
                  .pressure_hPa = maybe_number(),
                  .humidity_pct = maybe_number()};
  if (*rc::gen::arbitrary<bool>()) reading.compensated = *rc::gen::arbitrary<bool>();
  if (const auto value = maybe_number()) reading.sensors_degC["t_air_degC"] = *value;
  if (const auto value = maybe_number()) reading.extras["spindle_rpm"] = *value;
  if (const std::string word = text(); !word.empty()) reading.text_extras["remark"] = "x" + word;
  return reading;
}

}  // namespace

TEST_CASE("what is written is read back exactly") {
  CHECK(rc::check([] {
    MeasurementSet set{.source = "m.csv",
                       .metadata = {{"machine", "mill"}, {"", "free words"}, {"date", "2024-05-06 09:10"}}};
    const int count = *rc::gen::inRange(1, 12);
    for (int i = 0; i < count; ++i) {
      set.readings.push_back(arbitrary_reading());
      set.readings.back().row = i + 1;
      set.readings.back().line = i + 5;
    }
    const auto again = parse_measurement_set(to_csv(set), "m.csv");
    RC_ASSERT(again.has_value());
    RC_ASSERT(again->metadata == set.metadata);
    RC_ASSERT(again->readings == set.readings);
    RC_ASSERT(to_csv(*again) == to_csv(set));
  }));
}

namespace ecs::laser {
namespace {

TEST_CASE("machine and serial number are found in our header and in an instrument's own") {
  CHECK(measured_machine({{"machine", "mill"}, {"serial_number", "7"}}).serial_number == "7");
  const MeasuredMachine instrument = measured_machine({{"Owner", "x"}, {"Machine", "VMC 7"}, {"Serial No", "1234"}});
  CHECK(instrument.name == "VMC 7");
  CHECK(instrument.serial_number == "1234");
  CHECK(measured_machine({}).name.empty());
}

TEST_CASE("another machine is one whose name or serial number contradicts; what is not said contradicts nothing") {
  CHECK(other_machine({"mill", ""}, {"lathe", ""}, "the machine file is of") ==
        "measured on \"mill\", the machine file is of \"lathe\"");
  CHECK(other_machine({"mill", "1"}, {"mill", "2"}, "the parameters are of") ==
        "measured on serial number 1, the parameters are of serial number 2");
  CHECK_FALSE(other_machine({"mill", ""}, {"", "2"}, "x").has_value());
  CHECK_FALSE(other_machine({"mill", "1"}, {"mill", "1"}, "x").has_value());
}

TEST_CASE("targets beyond a twentieth of the travel speak against the machine file") {
  CHECK_FALSE(beyond_travel("X", Axis::X, {-25.0, 525.0}, {0.0, 500.0}).has_value());
  CHECK(beyond_travel("X", Axis::X, {-25.1, 500.0}, {0.0, 500.0}) ==
        "X was measured from -25.1 to 500 mm, but X travels from 0 to 500 mm: do file and machine belong together?");
  CHECK(beyond_travel("X", Axis::X, {0.0, 525.1}, {0.0, 500.0}).has_value());
}

}  // namespace
}  // namespace ecs::laser

TEST_CASE("texts leave for a file without a character that a terminal obeys or a spreadsheet computes") {
  MeasurementSet set = must(read_measurement_set("samples/laser/x_axis.csv"));
  set.metadata = {{"machine", "mill\x1b[31m\n# x\u009b\u202e"}};
  for (Reading& reading : set.readings) reading.text_extras = {{"operator", "=cmd|'/C calc'!A0"}};
  set.readings.front().text_extras = {{"operator", "''@NN\x1b"}};
  const std::string text = to_csv(set);
  CHECK(text.starts_with("# machine: mill?[31m # x??\n"));
  CHECK(text.find(",=") == std::string::npos);
  const MeasurementSet again = must(parse_measurement_set(text, "again.csv"));
  CHECK(again.readings.back().text_extras.at("operator") == "=cmd|'/C calc'!A0");
  CHECK(again.readings.front().text_extras.at("operator") == "''@NN?");
}
