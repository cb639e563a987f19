#include <cstdlib>

#include "base/file.hpp"
#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

CentroidOptions a_thousand() {
  CentroidOptions options;
  options.counts_per_mm = 1000.0;
  return options;
}

/// Mean compensation 0, 5.5, 11 um at 0, 50, 100 mm.
ExportSource centroid_example() {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 50, 100}, {-1.5, 4, 9.5}, {1.5, 7, 12.5});
  return source;
}

std::string refused_table(const std::string& text, const CentroidOptions& options = a_thousand()) {
  const auto read = parse_centroid(text, "CNC7X.TAB", Axis::X, options);
  return read ? std::string("read") : to_text(read.error());
}

TEST_CASE("a table holds its number of values and its travel, then the mean of both approaches, in counts") {
  CentroidOptions options;
  options.counts_per_mm = 2000.0;
  const auto made = must(centroid_export(centroid_example(), options));
  CHECK(file_named(made, "CNC7X.TAB").content == "3 200000\r\n0\r\n11\r\n22\r\n");  // 5.5 um are 11 counts
  const ExportedTable& table = only(made.tables);
  CHECK(table.points == 3);
  CHECK(table.largest == Approx(11.0));
  CHECK(table.deviation == Approx(1.5));  // half the reversal
  CHECK(table.shift == Approx(0.0));
  CHECK(leaves(made, "half the reversal of EXX"));
  CHECK(made.not_carried.front().largest == Approx(1.5));
  CHECK(leaves(made, "C0Y"));
  for (const char* words : {"values and travel are in encoder counts", "the control adds a value", "versions 2 and 3"})
    CHECK(laser::says(made.notes, words));
  options.adds = false;
  CHECK(centroid_export(centroid_example(), options)->files[0].content == "3 200000\r\n0\r\n-11\r\n-22\r\n");
}

TEST_CASE("a table runs from home, where it is zero, towards the far end: back from the upper end, and from outside") {
  ExportSource source = centroid_example();
  source.parameters.axes[index_of(Axis::X)].datum.reference_position_mm = 100.0;
  const auto back = must(centroid_export(source, a_thousand()));
  CHECK(back.files[0].content == "3 -100000\r\n0\r\n-6\r\n-11\r\n");  // -5.5 rounded away from zero
  CHECK(back.tables[0].shift == Approx(11.0));
  CHECK(back.applied.tables[0].position_mm == std::vector<double>{0.0, 50.0, 100.0});
  CHECK(back.applied.tables[0].compensation == std::vector<double>{-11.0, -6.0, 0.0});
  CentroidOptions outside = a_thousand();
  outside.home_mm[index_of(Axis::X)] = -50.0;  // the end value holds as far as home
  CHECK(centroid_export(source, outside)->files[0].content == "4 150000\r\n0\r\n0\r\n6\r\n11\r\n");
}

TEST_CASE("a home inside the table is refused, with both named") {
  CentroidOptions inside = a_thousand();
  inside.home_mm[index_of(Axis::X)] = 40.0;
  const auto refused = must_fail(centroid_export(centroid_example(), inside));
  CHECK(contains(refused.message, "X: home (40 mm) is inside the table (0 to 100 mm)"));
  inside.counts_per_mm = 0.001;
  inside.home_mm[index_of(Axis::X)] = 0.0;
  CHECK(contains(must_fail(centroid_export(centroid_example(), inside)).message, "shorter than one encoder count"));
  ExportSource source = small_machine();
  source.map.tables = {{Component::EYX, Approach::unknown, {0, 1}, {1, 1}}};
  CHECK(contains(must_fail(centroid_export(source, a_thousand())).message, "no positioning table"));
}

TEST_CASE("values are at even steps: an uneven map gets as many as follow it, at most as many as are asked for") {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 10, 40, 100}, {0, 10, 40, 100}, {0, 10, 40, 100});
  const auto line = must(centroid_export(source, a_thousand()));
  CHECK(line.tables[0].deviation == Approx(0.0).epsilon(1e-9));
  CentroidOptions few = a_thousand();
  few.most_points = 2;
  CHECK(centroid_export(source, few)->files[0].content == "2 100000\r\n0\r\n100\r\n");
}

TEST_CASE("a table is read as compensation from home on, equal for both approaches, whatever its direction") {
  const auto read = must(parse_centroid("3 -1448\n0\n-32\n-38\n\n", "CNC7Y.TAB", Axis::Y, a_thousand()));
  const laser::MapTable& table = only(read.tables);
  CHECK(table.component == Component::EYY);
  CHECK(table.approach == Approach::unknown);
  CHECK(table.position_mm == std::vector<double>{-1.448, -0.724, 0.0});
  CHECK(table.compensation == std::vector<double>{-38.0, -32.0, 0.0});
  CHECK(laser::says(read.notes, "CNC7Y.TAB: 3 values every 0.724 mm from 0 mm to -1.448 mm"));
  CHECK(laser::says(read.notes, "assumed, because the available description does not state it"));
  CentroidOptions other = a_thousand();
  other.adds = false;
  other.home_mm[index_of(Axis::Y)] = 10.0;
  const auto turned = must(parse_centroid("2 2000\r\n4\r\n6\r\n", "CNC7Y.TAB", Axis::Y, other));
  CHECK(turned.tables[0].position_mm == std::vector<double>{10.0, 12.0});
  CHECK(turned.tables[0].compensation == std::vector<double>{-4.0, -6.0});
}

TEST_CASE("the public table has 23 steps of 50 mm at 32000 counts an inch") {
  const char* const root = std::getenv("ECS_REAL_DATA");
  SKIP_UNLESS(root != nullptr, "ECS_REAL_DATA is not set");
  const auto text = must(read_file(std::string(root) + "/centroid-tab/cnc7x_v1.tab"));
  CHECK(recognised_format(text) == controller_format("centroid"));
  CentroidOptions options;
  options.counts_per_mm = 32000.0 / 25.4;
  const auto read = must(parse_centroid(text, "cnc7x_v1.tab", Axis::X, options));
  const laser::MapTable& table = only(read.tables);
  REQUIRE(table.position_mm.size() == 24);
  CHECK(table.position_mm.front() == Approx(-1150.0).epsilon(1e-6));
  CHECK(table.position_mm[22] == Approx(-50.0).epsilon(1e-6));
  CHECK(table.compensation.front() == Approx(-117.475));
}

TEST_CASE("broken tables are refused all at once, with their places") {
  check_holds(refused_table("3 1000\n1.5\n 0x3\n2\n"),
              {"CNC7X.TAB:2:1: expected a whole number of counts, found \"1.5\"", "CNC7X.TAB:3:2: expected a whole"});
  CHECK(contains(refused_table("4 1000\n0\n1\n2\n"), "CNC7X.TAB:1:1: the heading announces 4 values, the file has 3"));
  CHECK(contains(refused_table("2 1000\n0\n1\n2\n"), "the heading announces 2 values, the file has 3"));
  CHECK(contains(refused_table("1 1000\n0\n"), "CNC7X.TAB:1:1: expected the number of values, from 2 to"));
  CHECK(contains(refused_table("3 -1\n0\n0\n0\n"),
                 "CNC7X.TAB:1:3: expected the travel in counts, at least one for each step"));
  CHECK(contains(refused_table("3 0\n0\n0\n0\n"), "expected the travel in counts"));
  CHECK(contains(refused_table("X 100 50 MM\n0 1\n"),
                 "CNC7X.TAB:1:1: expected two whole numbers, of values and of counts"));
  CHECK(contains(refused_table("X 100 50 MM\n0 1\n"), "versions 2 and 3"));
  CHECK(contains(refused_table("\n\n"), "the file is empty"));
  CHECK(contains(refused_table("2 1000\n0\n99000\n"), "CNC7X.TAB:3:1: a compensation of 99 mm is implausibly large"));
  CHECK(contains(refused_table("2 9000000000000\n0\n1\n"), "expected the travel in counts"));
  CHECK(contains(refused_table("2 999000000000\n0\n1\n"), "9.99e+08 mm is not a plausible position"));
}

TEST_CASE("the counts of a table are asked for, and its options are checked") {
  const ControllerFormat& format = *controller_format("centroid");
  const auto with = [&](std::initializer_list<std::pair<std::string_view, std::string>> given) {
    OptionValues options(format.read_options);
    for (const auto& [name, value] : given) options.set(name, value);
    const auto read = format.read({"cnc10z.tab", "2 1000\n0\n1\n", "", true, options});
    return read ? std::string(name_of(read->tables[0].component)) : read.error().message;
  };
  CHECK(contains(with({}), "--counts-per-mm is needed"));
  CHECK(with({{"counts-per-mm", "1259.8425"}}) == "EZZ");
  CHECK(with({{"counts-per-mm", "1000"}, {"axis", "y"}}) == "EYY");
  for (const char* wrong : {"0", "-3", "many", "1e9"})
    CHECK(contains(with({{"counts-per-mm", wrong}}), "--counts-per-mm: expected a number above 0"));
  CHECK(contains(with({{"counts-per-mm", "1000"}, {"home", "5"}}), "--home: expected X=MM,Y=MM,Z=MM"));
  CHECK(contains(must_fail(format.write(centroid_example(), OptionValues(format.write_options))).message,
                 "--counts-per-mm is needed"));
}

TEST_CASE("the writer's own file names are known, and a short or long table is still one of Centroid") {
  const ControllerFormat& format = *controller_format("centroid");
  CHECK(format.is_file("CNC7Z.TAB"));
  CHECK_FALSE(format.is_file("cnc10z.tab"));
  for (const char* text : {"24 -1448819\n0\n", "\n3 5\r\n\r\n0\r\n"}) CHECK(format.recognises(text));
  for (const char* text : {"24 -1448819\n0 1\n", "1 2 3\n4\n", "24\n0\n", "1.5 3\n0\n", ""})
    CHECK_FALSE(format.recognises(text));
}

}  // namespace
}  // namespace ecs::controllers
