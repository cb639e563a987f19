#include <sstream>

#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

/// Compensation: +4 um forward and +7 um reverse at 50 mm, as in the manual's example.
ExportSource linuxcnc_example() {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 50, 100}, {0, 4, 9}, {3, 7, 13});
  return source;
}

LinuxCncReadOptions as(int type, Axis axis = Axis::X) { return {axis, type, MachineUnits::mm, false}; }

TEST_CASE("the axis is a letter of its own at the end of the name") {
  ReadRequest request;
  for (const char* name : {"y.comp", "mill_y.comp", "millY.comp"}) {
    request.file_name = name;
    CHECK(must(axis_of_file(request)) == Axis::Y);
  }
  request.file_name = "proxy.comp";
  CHECK(contains(must_fail(axis_of_file(request)).message, "a name that ends in an axis letter of its own"));
}

TEST_CASE("type 1 holds what is added, in mm: nominal, forward trim, reverse trim") {
  const auto made = must(linuxcnc_export(linuxcnc_example(), {}));
  CHECK(file_named(made, "x.comp").content ==
        "0.000000 0.000000 0.003000\n50.000000 0.004000 0.007000\n100.000000 0.009000 0.013000\n");
  CHECK(made.settings == std::vector<std::string>{"[JOINT_0]", "COMP_FILE = x.comp", "COMP_FILE_TYPE = 1"});
}

TEST_CASE("type 0 holds where the machine really is: nominal minus compensation") {
  CHECK(file_named(must(linuxcnc_export(linuxcnc_example(), {0, MachineUnits::mm, 256})), "x.comp").content ==
        "0.000000 0.000000 -0.003000\n50.000000 49.996000 49.993000\n100.000000 99.991000 99.987000\n");
}

TEST_CASE("a machine in inches gets inches, values and positions") {
  const auto made = must(linuxcnc_export(linuxcnc_example(), {1, MachineUnits::inch, 256}));
  std::istringstream file(file_named(made, "x.comp").content);
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  CHECK(line == "1.96850394 0.00015748 0.00027559");  // 50/25.4, 0.004/25.4, 0.007/25.4
  const auto read =
      must(parse_linuxcnc(file_named(made, "x.comp").content, "x.comp", {Axis::X, 1, MachineUnits::inch, false}));
  CHECK(compensation_at(read.tables[1], 50.0) == Approx(7.0).epsilon(1e-4));
}

TEST_CASE("what was written comes back, whatever the type") {
  for (const int type : {0, 1}) {
    const ExportSource source = whole_machine();
    const auto made = must(linuxcnc_export(source, {type, MachineUnits::mm, 256}));
    for (const Axis axis : kAllAxes) {
      const std::string name = {static_cast<char>('x' + static_cast<int>(axis)), '.', 'c', 'o', 'm', 'p'};
      const auto read = must(parse_linuxcnc(file_named(made, name).content, name, as(type, axis)));
      CHECK(read.warnings.empty());
      const Component component = curve_of(static_cast<Sense>(axis), axis);
      for (const Approach approach : {Approach::forward, Approach::reverse}) {
        const laser::MapTable& own = *table_of(source.map, component, approach);
        const laser::MapTable& back = read.tables[approach == Approach::forward ? 0 : 1];
        CHECK(back.position_mm == own.position_mm);
        for (std::size_t i = 0; i < own.compensation.size(); ++i)
          CHECK(back.compensation[i] == Approx(own.compensation[i]).epsilon(1e-3));
      }
    }
  }
}

TEST_CASE("points closer than a nanometre are merged, and the deviation is reported") {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 1e-9, 100}, {0, 50, 2}, {0, 50, 2});
  const auto made = must(linuxcnc_export(source, {}));
  CHECK(made.tables[0].points == 2);
  CHECK(made.tables[0].deviation == Approx(50.0));
}

TEST_CASE("lines that end in CR alone are read, with a note on what LinuxCNC would do") {
  LinuxCncReadOptions options;
  options.type = 1;
  const auto read = must(parse_linuxcnc("0 0.001 0.001\r100 0.002 0.002\r", "x.comp", options));
  CHECK(read.tables[0].position_mm == std::vector<double>{0, 100});
  CHECK(contains(only(read.warnings).message, "CR alone"));
  CHECK(parse_linuxcnc("0 0.001 0.001\r\n100 0.002 0.002\r\n", "x.comp", options)->warnings.empty());
}

TEST_CASE("more points than LinuxCNC takes are thinned to 256, and the deviation is reported") {
  ExportSource source = small_machine();
  std::vector<double> p, forward, reverse;
  for (int i = 0; i < 400; ++i) {
    p.push_back(0.5 * i);
    forward.push_back(i % 2 == 0 ? 1.0 : 0.0);
    reverse.push_back(0.0);
  }
  add_table(source, Component::EXX, p, forward, reverse);
  const auto made = must(linuxcnc_export(source, {}));
  CHECK(made.tables[0].map_points == 400);
  CHECK(made.tables[0].points <= 256);
  CHECK(made.tables[0].deviation > 0.4);
  CHECK(made.tables[0].deviation <= 1.0);
}

TEST_CASE("points closer than the last digit do not repeat a nominal position") {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 1e-8, 10}, {1, 2, 3}, {1, 2, 3});
  const auto made = must(linuxcnc_export(source, {}));
  CHECK(file_named(made, "x.comp").content == "0.000000 0.001000 0.001000\n10.000000 0.003000 0.003000\n");
}

TEST_CASE("everything but positioning stays behind, and is named with its size") {
  const auto made = must(linuxcnc_export(whole_machine(), {}));
  CHECK(made.not_carried.size() == 15 + 3);
  CHECK(leaves(made, "EYX"));
  CHECK(leaves(made, "ECX"));
  CHECK(leaves(made, "C0Y"));
  CHECK_FALSE(leaves(made, "EXX"));
}

TEST_CASE("maps that cannot be a table are refused with every reason") {
  ExportSource source = small_machine();
  auto made = linuxcnc_export(source, {});
  REQUIRE_FALSE(made);
  CHECK(made.error().kind == ProblemKind::refused);
  CHECK(contains(made.error().message, "no tables"));
  source.map.tables.push_back({Component::EXX, Approach::forward, {0}, {1}});
  made = linuxcnc_export(source, {});
  REQUIRE_FALSE(made);
  CHECK(contains(to_text(made.error()), "a table of one point"));
  CHECK(contains(to_text(made.error()), "one approach only"));
  source.map.tables = {{Component::EYX, Approach::unknown, {0, 1}, {1, 1}}};
  made = linuxcnc_export(source, {});
  REQUIRE_FALSE(made);
  CHECK(contains(made.error().message, "no positioning table"));
}

TEST_CASE("the reader reports where LinuxCNC stops without a message") {
  const std::string text = "# X\n0 0 0\n50 0.004 0.007\n\n100 0.009 0.013\n";
  const auto whole = must(parse_linuxcnc(text, "x.comp", as(1)));
  CHECK(whole.tables[0].position_mm == std::vector<double>{0, 50, 100});
  CHECK(only(whole.warnings).line == 1);
  CHECK(contains(whole.warnings[0].message, "a comment"));

  LinuxCncReadOptions loaded = as(1);
  loaded.as_loaded = true;
  CHECK_FALSE(parse_linuxcnc(text, "x.comp", loaded));  // it takes nothing of this file
  const auto part = must(parse_linuxcnc(text.substr(4), "x.comp", loaded));
  CHECK(part.tables[0].position_mm == std::vector<double>{0, 50});
  CHECK(only(part.warnings).line == 3);
  CHECK(contains(part.warnings[0].message, "an empty line"));
}

TEST_CASE("an empty last line has no effect and is not mentioned") {
  const auto read = must(parse_linuxcnc("0 0 0\r\n50 0.004 0.007\r\n\r\n", "x.comp", as(1)));
  CHECK(read.warnings.empty());
  CHECK(read.tables[0].position_mm == std::vector<double>{0, 50});
}

TEST_CASE("rows that do not rise, text after three numbers, and points after 256 give warnings") {
  const auto read = must(parse_linuxcnc("0 0 0\n50 0.1 0.1 ; half way\n50 0.2 0.2\n100 0 0\n", "x.comp", as(1)));
  CHECK(read.tables[0].position_mm == std::vector<double>{0, 50, 100});
  REQUIRE(read.warnings.size() == 2);
  CHECK(read.warnings[0].line == 2);
  CHECK(read.warnings[1].line == 3);
  CHECK(contains(read.warnings[1].message, "does not increase"));

  std::string many;
  for (int i = 0; i < 300; ++i) many += std::to_string(i) + " 0.001 0.002\n";
  const auto all = must(parse_linuxcnc(many, "x.comp", as(1)));
  CHECK(all.tables[0].position_mm.size() == 300);
  CHECK(only(all.warnings).line == 257);
  LinuxCncReadOptions loaded = as(1);
  loaded.as_loaded = true;
  CHECK(parse_linuxcnc(many, "x.comp", loaded)->tables[0].position_mm.size() == 256);
}

TEST_CASE("typing errors are refused all at once, with line and column") {
  const auto read = must_fail(parse_linuxcnc("0 0 0\n1O0 0 0\n200 0,5 0\n300 1\n400 nan 0\n", "x.comp", as(1)));
  const std::string said = to_text(read);
  check_holds(said, {"x.comp:2:1: expected a number, found \"1O0\"",
                     "x.comp:3:5: expected a number, found \"0,5\" (use a decimal point",
                     "x.comp:4:6: expected three numbers, found 2", "x.comp:5:5: expected a number, found \"nan\""});
}

TEST_CASE("an empty file and implausible values are refused") {
  CHECK_FALSE(parse_linuxcnc("", "x.comp", as(1)));
  CHECK_FALSE(parse_linuxcnc("0 0 0\n100 100.1 100.1\n", "x.comp", as(1)));  // positions taken for trims
  CHECK_FALSE(parse_linuxcnc("0 0 0\n1e300 0 0\n", "x.comp", as(1)));
}

TEST_CASE("the type shows in the numbers, unless they leave it open") {
  const LinuxCncReadOptions open{Axis::X, std::nullopt, MachineUnits::mm, false};
  CHECK(compensation_at(parse_linuxcnc("0 0 0\n50 49.996 49.993\n", "x", open)->tables[0], 50.0) == Approx(4.0));
  CHECK(compensation_at(parse_linuxcnc("0 0 0\n50 0.004 0.007\n", "x", open)->tables[0], 50.0) == Approx(4.0));
  CHECK(contains(must_fail(parse_linuxcnc("0 0 0\n0.01 0.005 0.006\n", "x", open)).message, "--type"));
}

TEST_CASE("the table that LinuxCNC ships for its simulated machine is read, its bad point and all") {
  const auto text = must(read_file("tests/data/real/linuxcnc-comp/screwcompX.dat"));
  const auto read = must(parse_linuxcnc(text, "screwcompX.dat", {Axis::X, std::nullopt, MachineUnits::mm, false}));
  REQUIRE(read.tables.size() == 2);
  CHECK(read.tables[0].position_mm.size() == 11);
  CHECK(read.tables[0].compensation[0] == Approx(1.0));    // −10 − (−10.001) mm
  CHECK(read.tables[1].compensation[0] == Approx(-1.0));   // −10 − (−9.999)
  CHECK(read.tables[0].compensation[3] == Approx(200.0));  // −4 − (−4.2)
}

}  // namespace
}  // namespace ecs::controllers
