// The error map: text form, bytes, completeness; maps as editors save them: UTF-16, code pages, a byte order mark; and
// what is no text.

#include <fmt/format.h>
#include <rapidcheck.h>

#include "core/memory_image.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/error_map.hpp"
#include "laser/map/image.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

ErrorMap small_map() {
  ErrorMap map;
  map.header.customer = "A customer: with a colon";
  map.header.machine = "mill 7";
  map.header.serial_number = "1234";
  map.header.date = "2026-02-03";
  map.header.engineer = "N. N.";
  map.header.configuration = "TX";
  map.header.sources = {{"EXX", "x run 1.csv", std::string(64, 'a')}};
  map.header.declared_zero = {{Component::EBY, "cannot be measured"}};
  map.header.uncertainty = {{Component::EXX, 0.98, 0.18, 4}};
  map.header.processing = {"EXX averaged over 3 runs"};
  map.tables = {{Component::EXX, Approach::forward, {0.0, 50.0, 100.0}, {0.0, -1.25, -3.5}},
                {Component::EXX, Approach::reverse, {0.0, 50.0, 100.0}, {0.5, -0.75, -3.0}}};
  return map;
}

ErrorMap warm_map() {
  ErrorMap map = small_map();
  map.header.inputs = {{2, "t_spindle_degC"}, {15, "t_material_degC"}};
  map.header.thermal = {{Component::EXX, ThermalLaw::growth, 15, kNoInput, -11.5, 20.0, 0.0, -4100.0},
                        {Component::EXX, ThermalLaw::shift, 2, 3, 0.1 + 0.2, 0.0, 1.0 / 3.0, 0.0},
                        {Component::EXX, ThermalLaw::shift, kMotionOfX, kNoInput, 12.0, 900.0, 1800.0, 0.0},
                        {Component::EXX, ThermalLaw::shift, kLoadInput, kNoInput, 0.01, 0.0, 0.0, 0.0}};
  map.header.thermal_settings.hold_s = 90.0;
  return map;
}

/// Of a one-axis machine X, for small_map().
UnitParameters parameters_of_x() {
  UnitParameters parameters;
  parameters.configuration = {'T', 'X', 0, 0, 0};
  parameters.axis_present = {true, false, false};
  parameters.scope = Scope::linear;
  return parameters;
}

}  // namespace

TEST_CASE("thermal rows are lines of the text, numbers of the image, and come back from both to the last bit") {
  const ErrorMap map = warm_map();
  const std::string text = to_map_csv(map);
  check_holds(text,
              {"# input: 3 t_spindle_degC\n",
               "# thermal: EXX growth input=16 coefficient=-11.5 reference=20 lag_s=0 origin_mm=-4100\n",
               "# thermal: EXX shift input=3 minus=4 coefficient=0.30000000000000004 reference=0",
               "# thermal: EXX shift input=motion_X coefficient=12 reference=900 lag_s=1800",
               "# thermal: EXX shift input=load coefficient=0.01", "# thermal_settings: rate_um_per_s=0.5 hold_s=90 "});
  CHECK(must(parse_map_csv(text, "map.csv")) == map);
  const MapImage image = must(image_of(map, parameters_of_x()));
  CHECK(ImageView(image.bytes).format() == kFormatWithThermal);
  CHECK_FALSE(contains(ImageView(image.bytes).header(), "thermal"));
  CHECK(must(content_of(image.bytes)).map == map);
  const MapImage cold = must(image_of(small_map(), parameters_of_x()));
  CHECK(ImageView(cold.bytes).format() == kImageFormat);
}

TEST_CASE("a thermal line that is none is refused with its line and a row to compare with") {
  const auto refused = [](const std::string& line) {
    return to_text(must_fail(
        parse_map_csv("# machine: m\n# " + line + "\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\n", "map.csv")));
  };
  for (const char* line : {"thermal: EXX growth input=17 coefficient=1 reference=20 lag_s=0 origin_mm=0",
                           "thermal: EXX melting input=1 coefficient=1 reference=20 lag_s=0 origin_mm=0",
                           "thermal: C0Y shift input=1 coefficient=1 reference=20 lag_s=0 origin_mm=0",
                           "thermal: EAX growth input=1 coefficient=1 reference=20 lag_s=0 origin_mm=0",
                           "thermal: EXX growth input=1 minus=load coefficient=1 reference=20 lag_s=0 origin_mm=0",
                           "thermal: EXX growth input=1 coefficient=1e9 reference=20 lag_s=0 origin_mm=0",
                           "thermal: EXX growth input=1 reference=20 lag_s=0 origin_mm=0"})
    check_holds(refused(line), {"map.csv:2", "thermal: expected a row such as EZZ shift input=5 coefficient=2.4"});
  CHECK(contains(refused("thermal_settings: rate_um_per_s=9"), "expected numbers within the ranges of the unit"));
  CHECK(contains(refused("thermal_settings: speed=1"), "expected key=number, found \"speed=1\""));
  CHECK(contains(refused("input: 0 t_x_degC"), "input: expected a number 1 to 16 and a sensor"));
}

TEST_CASE("rows beyond the unit's room are an objection, rows that act on nothing a remark") {
  ErrorMap map = warm_map();
  map.header.thermal.resize(kMostThermalRows + 1, map.header.thermal.front());
  CHECK(
      contains(to_text(must_fail(image_of(map, parameters_of_x()))), "has 33 thermal rows, the unit has room for 32"));
  map.header.thermal = {{Component::EYX, ThermalLaw::shift, 0, kNoInput, 1.0, 20.0, 0.0, 0.0}};
  bool said = false;
  for (const MapFinding& finding : findings_for(map, parameters_of_x()))
    said =
        said || (!finding.objection && contains(finding.message, "thermal row EYX shift is not used by a TX machine"));
  CHECK(said);
}

namespace {

/// small_map() of a machine XYZ on a tilting rotary table.
ErrorMap map_of_five_axes() {
  ErrorMap map = small_map();
  map.header.configuration = "XYTZ";
  map.header.rotary_configuration = "XYACTZ";
  MapRotaryAxis a, c;
  a.axis = {'A', -0.001, 0.005, {1.0, 0.0, 0.0}, {600.0, 300.0, -560.0}, {0.0, 6.0, -9.0, 0.0, 14.0, -7.0}, 12.5};
  c.axis = {'C', 0.1 + 0.2, 0.5, {0.0, 0.0, 1.0}, {600.0, 300.0, -560.0}, {8.0, -5.5, 0.0, 18.0, -12.0, 0.0}, 0.0};
  c.start_deg = -30.0;
  c.increment_deg = 120.0;
  for (auto& side : c.compensation) side.fill({0.0, 0.0, 0.0});
  c.compensation[0][5] = {1.5, -2.25, 400.0};
  c.compensation[1][5] = {1.0, -2.0, 3.0};
  c.compensation[0][1] = c.compensation[1][1] = {0.01, 0.02, 0.03};
  map.header.rotary = {a, c};
  return map;
}

UnitParameters parameters_of_table() {
  UnitParameters parameters;
  parameters.configuration = {'X', 'Y', 'T', 'Z', 0};
  return parameters;
}

}  // namespace

TEST_CASE("a map may consist of rotary axes or of thermal rows alone, but not of nothing") {
  ErrorMap map = map_of_five_axes();
  map.tables.clear();
  CHECK(must(parse_map_csv(to_map_csv(map), "map.csv")) == map);
  map.header.thermal = {ThermalRow{}};
  map.header.rotary.clear();
  map.header.rotary_configuration.clear();
  CHECK(must(parse_map_csv(to_map_csv(map), "map.csv")).header.thermal.size() == 1);
  map.header.thermal.clear();
  check_holds(to_text(must_fail(parse_map_csv(to_map_csv(map), "map.csv"))), {"map.csv", "the map has no rows"});
}

TEST_CASE("rotary axes are lines of the text, numbers of the image, and come back from both to the last bit") {
  ErrorMap map = map_of_five_axes();
  const std::string text = to_map_csv(map);
  check_holds(text, {"# rotary_configuration: XYACTZ\n",
                     "# rotary_axis: A deg_per_count=-0.001 deadband_deg=0.005 zero_deg=12.5 direction=1,0,0 pivot_mm",
                     " pivot_mm=600,300,-560 location=0,6,-9,0,14,-7 start_deg=0 increment_deg=10\n",
                     "# rotary_curve: EXC 0 0,0,0\n", "# rotary_curve: EYC 0 0.01,0.02,0.03\n",
                     "# rotary_curve: ECC 1 1,-2,3\n", "# rotary_curve: ECC -1 1.5,-2.25,400\n"});
  CHECK(must(parse_map_csv(text, "map.csv")) == map);
  for (std::size_t c = 0; c < kCurves; ++c) map.header.declared_zero.push_back({static_cast<Component>(c), "test"});
  for (std::size_t c = kCurves; c < kComponents; ++c)
    map.header.declared_zero.push_back({static_cast<Component>(c), "test"});
  map.tables.clear();
  map.header.declared_zero.erase(map.header.declared_zero.begin());
  const MapImage image = must(image_of(map, parameters_of_table()));
  CHECK(ImageView(image.bytes).format() == kFormatWithRotary);
  CHECK_FALSE(contains(ImageView(image.bytes).header(), "rotary"));
  ErrorMap rounded = must(content_of(image.bytes)).map;
  CHECK(rounded.header.rotary[1].compensation[0][5] == std::vector{1.5, -2.3, 400.0});  // 400 um/m: counts of 0.1
  rounded.header.rotary[1].compensation[0][5][1] = -2.25;
  CHECK(rounded == map);
}

TEST_CASE("bending of a head is a line of the text and part of an image of format 5, and comes back from both") {
  ErrorMap map = map_of_five_axes();
  map.header.rotary_configuration = "XYTZCA";
  map.header.bending = {{1.5, 0.0, -0.1, 0.0, 0.0, 2.0}, {0.0, 100.0 / 3.0, 0.0, 0.0, -7.0, 0.0}};
  const std::string text = to_map_csv(map);
  check_holds(text, {"# rotary_bending: machine_um=1.5,0,-0.1,0,0,2 tool_um_per_m=0,33.333333333333336,0,0,-7,0\n"});
  CHECK(must(parse_map_csv(text, "map.csv")) == map);
  map.header.declared_zero.clear();
  for (std::size_t c = 0; c < kComponents; ++c) map.header.declared_zero.push_back({static_cast<Component>(c), "test"});
  UnitParameters parameters = parameters_of_table();
  parameters.tool_range_mm = {10.0, 10.0, 200.0};
  map.tables.clear();
  const MapImage image = must(image_of(map, parameters));
  CHECK(ImageView(image.bytes).format() == kFormatWithBending);
  CHECK_FALSE(contains(ImageView(image.bytes).header(), "bending"));
  CHECK(must(content_of(image.bytes)).map.header.bending == map.header.bending);
  map.header.rotary_configuration = "XYACTZ";
  check_holds(to_text(must_fail(image_of(map, parameters))),
              {"the rotary axes (XYACTZ) have bending, but no head that tilts"});
  const std::size_t line = text.find("# rotary_bending");
  for (const std::string_view wrong : {"machine_um=1,2,3,4,5,6", "machine_um=1 tool_um_per_m=1,2,3,4,5,6",
                                       "machine_um=1,2,3,4,5,6 tool_um_per_m=1,2,3,4,5,x"}) {
    std::string changed = text;
    changed.replace(line, changed.find('\n', line) - line, fmt::format("# rotary_bending: {}", wrong));
    CHECK(contains(to_text(must_fail(parse_map_csv(changed, "map.csv"))), "rotary_bending: expected machine_um and"));
  }
  const std::string alone = "# rotary_bending: machine_um=1,2,3,4,5,6 tool_um_per_m=1,2,3,4,5,6\n";
  CHECK(contains(to_text(must_fail(parse_map_csv(alone + to_map_csv(small_map()), "map.csv"))),
                 "below the lines rotary_axis"));
}

TEST_CASE("a line of rotary axes that is none is refused with its line") {
  const std::string axis =
      "# rotary_axis: C deg_per_count=0.001 deadband_deg=0.005 zero_deg=0 direction=0,0,1 pivot_mm=0,0,0 "
      "location=0,0,0,0,0,0 start_deg=0 increment_deg=10\n";
  const auto refused = [&](const std::string& line) {
    return to_text(
        must_fail(parse_map_csv(axis + "# " + line + "\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\n", "map.csv")));
  };
  check_holds(refused("rotary_curve: EXA 0 1,2"), {"map.csv:2", "a component of a rotary axis named in a line before"});
  CHECK(contains(refused("rotary_curve: EXC 2 1,2"), "expected the approach 1, -1 or 0 (both)"));
  CHECK(contains(refused("rotary_curve: EXC 0 1,x"), "numbers within 32000 with commas"));
  CHECK(contains(refused("rotary_curve: EXC 0 1,40000"), "numbers within 32000 with commas"));
  CHECK(contains(refused("rotary_curve: EXC 0 1,2\n# rotary_curve: EYC 0 1"), "2 values, as in the other curves of C"));
  CHECK(contains(refused("rotary_curve: EXC 0"), "a component such as EXC, an approach and values"));
  CHECK(contains(refused("rotary_axis: A deg_per_count=0.001"), "expected a letter and deg_per_count, deadband_deg"));
  CHECK(contains(refused("rotary_configuration: XYACTZXYZ"), "expected letters such as XYACTZ"));
}

TEST_CASE("rotary axes that do not go with the parameters are an objection with its reason") {
  const auto objections = [](const ErrorMap& map, const UnitParameters& parameters) {
    std::string all;
    for (const MapFinding& finding : findings_for(map, parameters))
      if (finding.objection) all += finding.message + "\n";
    return all;
  };
  ErrorMap map = map_of_five_axes();
  UnitParameters parameters = parameters_of_table();
  CHECK_FALSE(contains(objections(map, parameters), "rotary"));
  parameters.interpolation = Interpolation::nearest;
  CHECK(contains(objections(map, parameters), "the rotary axes (XYACTZ) need the scope volumetric"));
  map.header.rotary_configuration = "XYCTZA";
  CHECK(contains(objections(map, parameters_of_table()), "need a tool range along X, Y and Z"));
  map.header.rotary[1].increment_deg = 0.01;
  CHECK_FALSE(objections(map_of_five_axes(), parameters).empty());
}

TEST_CASE("a map written as text reads back as the same map, header and all") {
  const ErrorMap map = small_map();
  CHECK(must(parse_map_csv(to_map_csv(map), "map.csv")) == map);
}

TEST_CASE("every table survives the text form to the last bit") {
  rc::check("round trip of random tables", [] {
    ErrorMap map;
    MapTable table{*rc::gen::element(Component::EXX, Component::EAY, Component::ECZ), Approach::unknown, {}, {}};
    const int n = *rc::gen::inRange(1, 30);
    double p = *rc::gen::inRange(-100000, 100000) / 7.0;
    for (int i = 0; i < n; ++i) {
      table.position_mm.push_back(p);
      table.compensation.push_back(*rc::gen::inRange(-3'000'000, 3'000'000) / 997.0);
      p += *rc::gen::inRange(1, 1000) / 13.0;
    }
    map.tables = {table};
    const auto back = parse_map_csv(to_map_csv(map), "map.csv");
    RC_ASSERT(back.has_value());
    RC_ASSERT(*back == map);
  });
}

TEST_CASE("every bad row of a map is reported at once, with its line and column") {
  const std::string text =
      to_text(must_fail(parse_map_csv("axis,sense,approach,p_mm,value_um\n"
                                      "Q,EX,1,0,0\n"
                                      "X,EX,2,0,0\n"
                                      "X,EX,1,0,nan\n"
                                      "X,EX,1,ten,0\n"
                                      "X,EX,1,0\n"
                                      "X,EX,1,0,99999\n",
                                      "map.csv")));
  check_holds(text,
              {"map.csv:2:1: axis: expected X, Y or Z, found \"Q\"", "map.csv:3:6: approach", "map.csv:4:10: value_um",
               "map.csv:5:8: p_mm", "map.csv:6:1: expected 5 fields, found 4", "map.csv:7:10: value_um"});
}

TEST_CASE("a position given twice, and approach 0 beside 1, are refused") {
  const auto twice = must_fail(parse_map_csv("axis,sense,approach,p_mm,value_um\nX,EX,1,5,1\nX,EX,1,5,2\n", "m.csv"));
  CHECK(contains(twice.message, "twice"));
  const auto mixed = must_fail(parse_map_csv("axis,sense,approach,p_mm,value_um\nX,EX,1,5,1\nX,EX,0,5,2\n", "m.csv"));
  CHECK(contains(mixed.message, "approach 0"));
}

TEST_CASE("a header key that does not exist is refused with the line it has in the file") {
  const auto map = must_fail(
      parse_map_csv("# customer: A\n# colour: red\naxis,sense,approach,p_mm,value_um\nX,EX,0,5,1\n", "m.csv"));
  CHECK(map.line == 2);
  CHECK(contains(map.message, "colour"));
}

TEST_CASE("names in the header of a map hold no control characters and no more than a name has") {
  const std::string rows = "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,100,1\n";
  const auto map =
      must(parse_map_csv("# machine: mill\x1B]0;x\x07\n# processing: \xC2\x9B"
                         "2J\n" +
                             rows,
                         "map.csv"));
  CHECK(map.header.machine == "mill?]0;x?");
  CHECK(map.header.processing == std::vector<std::string>{"?2J"});
  CHECK(to_text(must_fail(parse_map_csv("#\n# machine: " + std::string(3'000'000, 'N') + "\n" + rows, "map.csv"))) ==
        "map.csv:2:1: header: \"machine\" has 3000000 bytes, expected at most 200");
  CHECK_FALSE(parse_map_csv("# processing: " + std::string(70'000, 'N') + "\n" + rows, "map.csv"));
  CHECK(parse_map_csv("# processing: " + std::string(60'000, 'N') + "\n" + rows, "map.csv"));
}

TEST_CASE("a map between its points is linear, and holds its end values beyond its ends") {
  const MapTable table{Component::EXX, Approach::unknown, {0.0, 10.0}, {1.0, 3.0}};
  CHECK(compensation_at(table, 5.0) == Approx(2.0));
  CHECK(compensation_at(table, -100.0) == 1.0);
  CHECK(compensation_at(table, 100.0) == 3.0);
}

TEST_CASE("the bytes of a map give back parameters, header and tables to the table's resolution") {
  const UnitParameters p = one_axis();
  const ErrorMap map = small_map();
  const auto image = must(image_of(map, p));
  CHECK(check_image(image.bytes).fault == ImageFault::none);
  const auto back = must(content_of(image.bytes));
  CHECK(back.parameters == p);
  CHECK(back.map.header == map.header);
  REQUIRE(back.map.tables.size() == 2);
  CHECK(back.map.tables[0].position_mm == map.tables[0].position_mm);
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(back.map.tables[1].compensation[i] == Approx(map.tables[1].compensation[i]).epsilon(1e-9));
}

TEST_CASE("values too large for hundredths of a micrometre are stored in tenths") {
  ErrorMap map = small_map();
  map.tables[0].compensation[2] = -1234.5;
  UnitParameters p = one_axis();
  p.axes[0].output_limit_um = 2000.0;
  CHECK(must(content_of(must(image_of(map, p)).bytes)).map.tables[0].compensation[2] == Approx(-1234.5));
}

TEST_CASE("unevenly spaced points are put on a grid at their smallest spacing, and the change is reported") {
  ErrorMap map = small_map();
  map.tables = {{Component::EXX, Approach::unknown, {0.0, 10.0, 40.0}, {0.0, 1.0, 4.0}}};
  const auto image = must(image_of(map, one_axis()));
  REQUIRE(image.notes.size() == 1);
  const auto back = must(content_of(image.bytes));
  CHECK(back.map.tables[0].position_mm.size() == 5);
  CHECK(compensation_at(back.map.tables[0], 25.0) == Approx(2.5));
}

TEST_CASE("a map that lacks a component names it and says what to do") {
  UnitParameters p;  // TXYZ, volumetric
  ErrorMap map = small_map();
  map.header.configuration = "TXYZ";
  const std::string text = to_text(must_fail(image_of(map, p)));
  check_holds(text, {"ECX (X axis rotation about Z", "declare it zero with a reason", "C0Y (squareness of Y to X)"});
  CHECK(!contains(text, "EBY"));  // declared zero
}

TEST_CASE("one approach alone is not a table for both") {
  ErrorMap map = small_map();
  map.tables.pop_back();
  CHECK(contains(must_fail(image_of(map, one_axis())).message, "one approach only"));
}

TEST_CASE("a map for another configuration is refused") {
  ErrorMap map = small_map();
  map.header.configuration = "XTYZ";
  CHECK(contains(must_fail(image_of(map, one_axis())).message,
                 "made for the machine configuration XTYZ, the parameters state TX"));
}

TEST_CASE("a component declared zero must not have values as well") {
  ErrorMap map = small_map();
  map.header.declared_zero = {{Component::EXX, "no time"}};
  CHECK(contains(must_fail(image_of(map, one_axis())).message, "declared zero but also has values"));
}

TEST_CASE("more values than the memory modules hold are refused, one module more and they fit") {
  ErrorMap map = small_map();
  MapTable large{Component::EXX, Approach::unknown, {}, {}};
  for (int i = 0; i < 32'001; ++i) {
    large.position_mm.push_back(i * 0.1);
    large.compensation.push_back(0.0);
  }
  map.tables = {large};
  UnitParameters p = one_axis();
  CHECK(contains(must_fail(image_of(map, p)).message, "32001 values"));
  p.memory_modules = 2;
  CHECK(image_of(map, p));
}

TEST_CASE("new parameters in an old image keep its tables and make a sound image again") {
  const auto image = must(image_of(small_map(), one_axis()));
  UnitParameters changed = one_axis();
  changed.axes[0].deadband_um = 7.5;
  const auto replaced = must(with_parameters(image.bytes, changed));
  const auto back = must(content_of(replaced));
  CHECK(back.parameters == changed);
  CHECK(back.map.header == small_map().header);
}

TEST_CASE("a changed byte anywhere in an image is noticed") {
  const auto image = must(image_of(small_map(), one_axis()));
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    auto damaged = image.bytes;
    damaged[i] ^= 0x10;
    CHECK_FALSE(content_of(damaged));
  }
}

TEST_CASE("a map file that lost its end is noticed, at every byte of its rows") {
  const std::string text = to_map_csv(small_map());
  const std::size_t first_row = text.find("value_um\n") + 9;
  for (std::size_t length = first_row; length < text.size(); ++length)
    CHECK_FALSE(parse_map_csv(text.substr(0, length), "map.csv"));
  CHECK(parse_map_csv(text, "map.csv"));
}

TEST_CASE("a hand-written map needs no row count and no last line end") {
  CHECK(parse_map_csv("axis,sense,approach,p_mm,value_um\nX,EX,0,0,1\nX,EX,0,5,2", "map.csv"));
}

TEST_CASE("a value that the output limit can never put out is refused with its place") {
  ErrorMap map = small_map();
  map.tables[1].compensation[1] = 31000.0;
  const auto image = must_fail(image_of(map, one_axis()));
  CHECK(image.message.find("EXX reverse requires 31000 um at 50 mm, but axis.X.output_limit_um is 500") == 0);
}

TEST_CASE("tables that do not reach the reference position, or end at different places, are refused") {
  ErrorMap shifted = small_map();
  for (MapTable& table : shifted.tables)
    for (double& p : table.position_mm) p += 50'000.0;
  CHECK(contains(must_fail(image_of(shifted, one_axis())).message, "does not reach the reference position 0 mm"));

  ErrorMap cut = small_map();
  for (const double p : {150.0, 200.0, 250.0, 300.0, 350.0}) {
    cut.tables[0].position_mm.push_back(p);
    cut.tables[0].compensation.push_back(0.0);
  }
  const auto uneven = must_fail(image_of(cut, one_axis()));
  CHECK(uneven.message.find("EXX covers 0 … 350 mm forward, but 0 … 100 mm in reverse") == 0);
}

TEST_CASE("a single point is not a table") {
  ErrorMap map = small_map();
  map.tables = {{Component::EXX, Approach::unknown, {0.0}, {40.0}}};
  CHECK(contains(must_fail(image_of(map, one_axis())).message, "one point only"));
}

TEST_CASE("a value that jumps gives a remark, not an error") {
  ErrorMap map = small_map();
  map.tables = {{Component::EXX, Approach::unknown, {}, {}}};
  for (int i = 0; i < 20; ++i) {
    map.tables[0].position_mm.push_back(10.0 * i);
    map.tables[0].compensation.push_back(i == 7 ? 120.0 : 0.5 * i);
  }
  const auto findings = findings_for(map, one_axis());
  CHECK_FALSE(only(findings).objection);
  CHECK(findings[0].message.find("EXX jumps by") == 0);
}

TEST_CASE("values come back from the bytes as the decimals they are") {
  ErrorMap map = small_map();
  map.tables[0].compensation = {0.35, -1.1, 0.07};
  const auto image = must(image_of(map, one_axis()));
  CHECK(content_of(image.bytes)->map.tables[0].compensation == std::vector<double>{0.35, -1.1, 0.07});
}

namespace ecs::laser {
namespace {

const std::string kMap =
    "# machine: Fraese\n# rows: 2\naxis,sense,approach,p_mm,value_um\r\nX,EX,0,0,0\r\nX,EX,0,100,-3.5\r\n";

std::string utf16(const std::string& text, bool big, bool mark) {
  std::string out = !mark ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) out += big ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

TEST_CASE("a map saved as UTF-16 is read as the same map") {
  const auto plain = must(parse_map_csv(kMap, "map.csv"));
  for (const bool big : {false, true})
    for (const bool mark : {false, true}) {
      CHECK(must(parse_map_csv(utf16(kMap, big, mark), "map.csv")) == plain);
    }
}

TEST_CASE("a machine's name in Windows-1252 is the name in UTF-8, so that it equals that of the parameters") {
  CHECK(must(parse_map_csv("# machine: Fr\xE4se 2\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\n", "map.csv"))
            .header.machine == "Fr\xC3\xA4se 2");
}

TEST_CASE("a NUL in a map is named with its place") {
  const auto read = must_fail(
      parse_map_csv(std::string("axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1\0,0\n", 54), "map.csv"));
  CHECK(to_text(read).starts_with("map.csv:3:9: a NUL byte (0)"));
}

TEST_CASE("UTF-16 cut in the middle of a letter is reported as such") {
  std::string cut = utf16(kMap, false, true);
  cut.pop_back();
  CHECK(contains(must_fail(parse_map_csv(cut, "map.csv")).message, "UTF-16"));
}

}  // namespace
}  // namespace ecs::laser
