#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

/// Compensation: +4 um forward and +7 um reverse at 50 mm, as in modules/controllers/README.md.
ExportSource twincat_example() {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 50, 100}, {0, 4, 9.04}, {3, 7, 13});
  return source;
}

std::string list(const std::string& more, int points = 2, const std::string& head = "kopf.achs_nr 1\n") {
  return head + "kw.ssfk.unit 1\nkw.ssfk.bilateral 1\nkw.ssfk.kw_nr_max " + std::to_string(points) + "\n" + more;
}

const char* const kTwoPoints =
    "kw.ssfk.table[0].setpoint 0\nkw.ssfk.table[0].pos 0\nkw.ssfk.table[0].neg 0\n"
    "kw.ssfk.table[1].setpoint 500000\nkw.ssfk.table[1].pos -40\nkw.ssfk.table[1].neg -70\n";

TEST_CASE("a list holds actual minus nominal in tenths of a micrometre, a table for each direction") {
  const auto made = must(twincat_export(twincat_example(), {}));
  CHECK(
      file_named(made, "achskw1.lis").content ==
      "# EXX error of X, actual minus nominal, in 0.1 um; pos and neg: direction of motion\n"
      "# sign as in the example of the TF5200 manual, not tried on a control: check one axis with the laser before use "
      "(the option --ssfk-sign adds reverses it)\n"
      "kopf.achs_nr 1\nkopf.log_achs_name X\nkw.ssfk.unit 1\nkw.ssfk.interval 0\nkw.ssfk.kw_startpos 0\n"
      "kw.ssfk.kw_nr_max 3\nkw.ssfk.bilateral 1\nkw.ssfk.modulo 0\n"
      "kw.ssfk.table[0].setpoint 0\nkw.ssfk.table[0].pos 0\nkw.ssfk.table[0].neg -30\n"
      "kw.ssfk.table[1].setpoint 500000\nkw.ssfk.table[1].pos -40\nkw.ssfk.table[1].neg -70\n"
      "kw.ssfk.table[2].setpoint 1000000\nkw.ssfk.table[2].pos -90\nkw.ssfk.table[2].neg -130\n");
  CHECK(made.tables[0].deviation == Approx(0.04));  // 9.04 um became 9.0
  CHECK(made.settings[1] == "start-up list: achs_kw_log_ax_nr[0] 1, achs_kw[0] achskw1.lis");
  CHECK(made.settings[2] == "list of axis 1: lr_param.ssfk 1");
}

TEST_CASE("each axis whose list is not zero at the reference position steps when it becomes active, and that is said") {
  ExportSource source = twincat_example();
  add_table(source, Component::EYY, {0, 100}, {0, 5}, {0, 5});
  const auto at_zero = must(twincat_export(source, {}));
  CHECK(laser::says(
      at_zero.notes,
      "at the reference position of X (0 mm) the list has 0.0 um in its column pos (forward) and "
      "-3.0 um in neg (reverse): the axis steps by one of these amounts when the compensation becomes active"));
  CHECK_FALSE(laser::says(at_zero.notes, "reference position of Y"));
  source.parameters.axes[index_of(Axis::Y)].datum.reference_position_mm = 50.0;
  CHECK(laser::says(twincat_export(source, {})->notes,
                    "at the reference position of Y (50 mm) the list has -2.5 um: the axis steps by this amount"));
  CHECK(laser::says(twincat_export(source, {{1, 2, 3}, 10, true})->notes, "of Y (50 mm) the list has 2.5 um:"));
}

TEST_CASE("the parameter that selects backlash compensation is named, not the one that holds its size") {
  CHECK(laser::says(must(twincat_export(twincat_example(), {})).notes,
                    "switch off the backlash compensation of these axes (P-AXIS-00021 lr_param.anwahl_losekomp 0)"));
}

TEST_CASE("values that do not fit 16 bit are named: 3276.7 um is the last that TwinCAT 2 takes") {
  ExportSource source = small_machine();
  add_table(source, Component::EXX, {0, 100}, {0, 3276.7}, {0, -3276.7});
  CHECK_FALSE(laser::says(twincat_export(source, {})->notes, "TwinCAT 2"));
  source.map.tables[1].compensation[1] = -3276.9;
  CHECK(laser::says(twincat_export(source, {})->notes,
                    "achskw1.lis has values up to 3276.9 um: values beyond 3276.7 um do not fit TwinCAT 2 (16 bit)"));
}

TEST_CASE("the writer's own file names are known, others are not") {
  for (const char* own : {"achskw1.lis", "achskw12.lis", "achskw65534.lis"}) CHECK(is_twincat_file(own));
  for (const char* other : {"achskw.lis", "achskw0.lis", "achskw01.lis", "achskw1.lis.bak", "Achskw1.lis", "x.comp"})
    CHECK_FALSE(is_twincat_file(other));
}

TEST_CASE("the worked example of the manual is read as it says: short by 10.2 um forward, long by 8.0 um in reverse") {
  const auto read =
      must(parse_twincat("kopf.log_achs_nr                     2\nkopf.log_achs_name                   Y-ACHSE\n"
                         "kw.ssfk.interval                     0\nkw.ssfk.kw_startpos                 -200000\n"
                         "kw.ssfk.kw_nr_max                    3\nkw.ssfk.unit                         1\n"
                         "kw.ssfk.bilateral                    1\n"
                         "kw.ssfk.table[0].setpoint           -200000\nkw.ssfk.table[1].setpoint           -199306\n"
                         "kw.ssfk.table[2].setpoint           -198667\n"
                         "kw.ssfk.table[0].pos                 0\nkw.ssfk.table[1].pos                 24\n"
                         "kw.ssfk.table[2].pos                -102\n"
                         "kw.ssfk.table[0].neg                 0\nkw.ssfk.table[1].neg                 67\n"
                         "kw.ssfk.table[2].neg                 80\n",
                         "achskw2.lis", {}));
  REQUIRE(read.tables.size() == 2);
  CHECK(read.tables[0].component == Component::EYY);
  CHECK(read.tables[0].position_mm[2] == Approx(-19.8667));
  // Programmed 19866.7 um, reached 19856.5 and 19874.7: what is to be added is what is lacking.
  CHECK(compensation_at(read.tables[0], -19.8667) == Approx(19866.7 - 19856.5));
  CHECK(compensation_at(read.tables[1], -19.8667) == Approx(19866.7 - 19874.7));
}

TEST_CASE("a control that adds the values gets the other sign, and its lists are read with it") {
  const TwinCatOptions options{{1, 2, 3}, kTwinCatMostPoints, true};
  const auto made = must(twincat_export(twincat_example(), options));
  const std::string& text = file_named(made, "achskw1.lis").content;
  CHECK(text.starts_with("# EXX error of X, nominal minus actual"));
  check_holds(text, {"\n# sign against the example of the TF5200 manual, not tried on a control",
                     "kw.ssfk.table[1].pos 40\nkw.ssfk.table[1].neg 70\n"});
  CHECK(compensation_at(parse_twincat(text, "a.lis", options)->tables[1], 50.0) == Approx(7.0));
  CHECK(compensation_at(made.applied.tables[1], 50.0) == Approx(7.0));
}

TEST_CASE("our own list is read with its own sign and refused with another") {
  TwinCatOptions subtracts, adds;
  subtracts.adds = false;
  adds.adds = true;
  for (const bool sign : {false, true}) {
    const auto made = must(twincat_export(twincat_example(), sign ? adds : subtracts));
    const std::string& text = file_named(made, "achskw1.lis").content;
    CHECK(compensation_at(parse_twincat(text, "a.lis", {})->tables[1], 50.0) == Approx(7.0));
    CHECK(compensation_at(parse_twincat(text, "a.lis", sign ? adds : subtracts)->tables[1], 50.0) == Approx(7.0));
    const auto wrong = must_fail(parse_twincat(text, "a.lis", sign ? subtracts : adds));
    CHECK(to_text(wrong).starts_with("a.lis:1:1: the list was written with --ssfk-sign " +
                                     std::string(sign ? "adds" : "subtracts")));
    const auto both =
        must_fail(parse_twincat(text + "# EXX error of X, " + (sign ? "actual minus nominal" : "nominal minus actual") +
                                    ", in 0.1 um; pos and neg: direction of motion\n",
                                "a.lis", {}));
    CHECK(contains(both.message, "a different sign from the previous one"));
  }
  CHECK(compensation_at(parse_twincat(list(kTwoPoints), "a.lis", {})->tables[1], 50.0) == Approx(7.0));
  CHECK(compensation_at(parse_twincat(list(kTwoPoints), "a.lis", adds)->tables[1], 50.0) == Approx(-7.0));
}

TEST_CASE("what was written comes back, to a tenth of a micrometre") {
  const ExportSource source = whole_machine();
  const TwinCatOptions options{{4, 7, 2}, kTwinCatMostPoints, false};
  const auto made = must(twincat_export(source, options));
  for (const Axis axis : kAllAxes) {
    const std::string name = "achskw" + std::to_string(options.axis_number[index_of(axis)]) + ".lis";
    const auto read = must(parse_twincat(file_named(made, name).content, name, options));
    const Component component = curve_of(static_cast<Sense>(axis), axis);
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      const laser::MapTable& own = *table_of(source.map, component, approach);
      const laser::MapTable& back = read.tables[approach == Approach::forward ? 0 : 1];
      CHECK(back.component == component);
      CHECK(back.approach == approach);
      CHECK(back.position_mm == own.position_mm);
      for (std::size_t i = 0; i < own.compensation.size(); ++i)
        CHECK(std::abs(back.compensation[i] - own.compensation[i]) <= 0.05 + 1e-9);
    }
  }
}

TEST_CASE("even steps and a table for both directions are read as well, whatever the case and the comments") {
  const auto read = must(parse_twincat(
      "# ***\nKOPF.ACHS_NR 3 ( the Z axis\nkopf.log_achs_name  Z_1\nKW.SSFK.UNIT 1 # metric\nkw.ssfk.interval 100000\n"
      "kw.ssfk.kw_startpos -200000 /* -20 mm\nkw.ssfk.kw_nr_max 3\nkw.ssfk.manual_activation 0\n"
      "kw.ssfk.table[2].pos 30 last\nkw.ssfk.table[0].pos 10\r\nkw.ssfk.table[1].pos 20\n"
      "kw.crosscomp.unit 1\nkw.crosscomp.table[0].correction 3\n",
      "achskw3.lis", {}));
  CHECK(read.tables[0].component == Component::EZZ);
  CHECK(read.tables[0].position_mm == std::vector<double>{-20, -10, 0});
  CHECK(read.tables[0].compensation == std::vector<double>{-1, -2, -3});
  CHECK(read.tables[1].compensation == read.tables[0].compensation);
  CHECK(contains(only(read.notes), "kw.crosscomp is not a leadscrew compensation, ignored"));
}

TEST_CASE("a list whose name and number say different axes is not guessed at") {
  const std::string text = list(kTwoPoints, 2, "kopf.achs_nr 1\nkopf.log_achs_name Y-ACHSE\n");
  const auto open = must_fail(parse_twincat(text, "a.lis", {}));
  CHECK(contains(open.message, "the name of the axis is Y, but its number 1 is that of X"));
  CHECK(parse_twincat(text, "a.lis", {{2, 1, 3}, 10, false})->tables[0].component == Component::EYY);
  CHECK(parse_twincat(text, "a.lis", {}, Axis::Z)->tables[0].component == Component::EZZ);
  const auto unknown = must_fail(parse_twincat(list(kTwoPoints, 2, "kopf.achs_nr 9\n"), "a.lis", {}));
  CHECK(contains(unknown.message, "the axis is unknown"));
}

TEST_CASE("a list of an axis not named X, Y or Z is refused, whatever its number, unless an axis is given") {
  const std::string text = list(kTwoPoints, 2, "kopf.achs_nr 3\nkopf.log_achs_name B-ACHSE\n");
  CHECK(to_text(must_fail(parse_twincat(text, "a.lis", {}))) ==
        "a.lis:2:1: the list belongs to axis \"B-ACHSE\": a map covers X, Y and Z; give --axis if it is one of them");
  CHECK(parse_twincat(text, "a.lis", {}, Axis::Z)->tables[0].component == Component::EZZ);
  for (const char* name : {"c", "U1"})
    CHECK_FALSE(parse_twincat(list(kTwoPoints, 2, "kopf.achs_nr 3\nkopf.log_achs_name " + std::string(name) + "\n"),
                              "a.lis", {}));
  for (const char* name : {"ACHSE3", "BETT", "3B"})
    CHECK(parse_twincat(list(kTwoPoints, 2, "kopf.achs_nr 3\nkopf.log_achs_name " + std::string(name) + "\n"), "a.lis",
                        {}));
}

TEST_CASE("increments, rotary axes, and a list for one direction that says two things are refused") {
  const auto refused = [](const std::string& text) {
    const auto read = parse_twincat(text, "a.lis", {});
    return read ? std::string("taken") : to_text(read.error());
  };
  const std::string good = list(kTwoPoints);
  CHECK(refused(good) == "taken");
  CHECK(refused("kopf.achs_nr 1\nkw.ssfk.kw_nr_max 2\nkw.ssfk.bilateral 1\n" + std::string(kTwoPoints))
            .find("encoder increments") != std::string::npos);
  CHECK(contains(refused(good + "kw.ssfk.modulo 1\n"), "a rotary axis"));
  CHECK(refused("kopf.achs_nr 1\nkw.ssfk.unit 1\nkw.ssfk.kw_nr_max 2\n" + std::string(kTwoPoints))
            .find("a.lis:9:1: neg differs from pos in a list for one direction") != std::string::npos);
}

TEST_CASE("broken lists are refused all at once, with their places") {
  const std::string said = to_text(
      must_fail(parse_twincat("kopf.achs_nr one\nkw.ssfk.unit 1\nkw.ssfk.colour 3\nG01 X5\nkw.ssfk.table[x].pos 3\n"
                              "kw.ssfk.table[0].pos 1,5\nkw.ssfk.unit 1\n",
                              "a.lis", {})));
  check_holds(said,
              {"a.lis:1:14: expected a number, found \"one\"", "a.lis:3:1: expected an entry of kw.ssfk",
               "a.lis:4:1: expected an entry such as kw.ssfk.unit 1", "a.lis:5:1: expected kw.ssfk.table[0] and so on",
               "a.lis:6:22: expected a number, found \"1,5\"", "a.lis:7:1: unit occurs twice (also in line 2)"});
}

TEST_CASE("points that are missing, fall back, are too many or too large are refused") {
  const auto said = [](const std::string& rows, int points) {
    const auto read = parse_twincat(list(rows, points), "a.lis", {});
    return read ? std::string("taken") : to_text(read.error());
  };
  CHECK(contains(said(kTwoPoints, 3), "kw.ssfk.table[2].setpoint is missing"));
  CHECK(contains(said(kTwoPoints, 1), "table[1] lies beyond the 1 points"));
  CHECK(contains(said("kw.ssfk.table[0].setpoint 5\nkw.ssfk.table[0].pos 0\n", 1), "table[0].neg is missing"));
  const std::string first = "kw.ssfk.table[0].setpoint 5\nkw.ssfk.table[0].pos 0\nkw.ssfk.table[0].neg 0\n";
  CHECK(said(first + "kw.ssfk.table[1].setpoint 5\nkw.ssfk.table[1].pos 0\nkw.ssfk.table[1].neg 0\n", 2)
            .find("does not rise") != std::string::npos);
  CHECK(said("kw.ssfk.table[0].setpoint 5\nkw.ssfk.table[0].pos 1e9\nkw.ssfk.table[0].neg 0\n", 1)
            .find("implausibly large") != std::string::npos);
  const std::string third = "kw.ssfk.table[2].setpoint 9\nkw.ssfk.table[2].pos 1e9\nkw.ssfk.table[2].neg 0\n";
  const std::string all =
      said(first + "kw.ssfk.table[1].setpoint 3\nkw.ssfk.table[1].pos 0\nkw.ssfk.table[1].neg 0\n" + third +
               "kw.ssfk.table[3].setpoint 10\nkw.ssfk.table[3].pos 0\n" + "kw.ssfk.table[6].pos 0\n",
           6);
  check_holds(all, {"position 0.0003 mm does not rise", "an error of", "table[3].neg is missing",
                    "table[4].setpoint is missing", "table[6] lies beyond the 6 points"});
  CHECK(!contains(all, "table[5]"));  // a first missing row stands for the rest
  CHECK(contains(said("", 0), "expected the number of points"));
  CHECK_FALSE(parse_twincat("", "a.lis", {}, Axis::X));
}

TEST_CASE("more points than a list takes are thinned, and points that fall together are one") {
  ExportSource source = small_machine();
  std::vector<double> p, forward, reverse;
  for (int i = 0; i < 2000; ++i) {
    p.push_back(0.1 * i);
    forward.push_back(10.0 * std::sin(0.05 * i));
    reverse.push_back(0.0);
  }
  p[1] = 0.00002;  // rounds to the point before it
  add_table(source, Component::EXX, p, forward, reverse);
  const auto made = must(twincat_export(source, {}));
  CHECK(made.tables[0].map_points == 2000);
  CHECK(made.tables[0].points <= kTwinCatMostPoints);
  CHECK(made.tables[0].deviation < 1.0);
  CHECK(must(twincat_export(source, {{1, 2, 3}, 20, false})).tables[0].points <= 20);
}

TEST_CASE("everything but positioning stays behind, and a map without positioning is refused") {
  const auto made = must(twincat_export(whole_machine(), {}));
  CHECK(made.not_carried.size() == 15 + 3);
  CHECK(leaves(made, "EYX"));
  CHECK(leaves(made, "C0Y"));
  ExportSource source = small_machine();
  source.map.tables = {{Component::EYX, Approach::unknown, {0, 1}, {1, 1}}};
  CHECK(contains(twincat_export(source, {}).error().message, "no positioning table"));
}

}  // namespace
}  // namespace ecs::controllers
