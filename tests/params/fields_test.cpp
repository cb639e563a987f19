#include "params/fields.hpp"

#include <cstdlib>
#include <set>

#include "base/file.hpp"
#include "params/position_unit.hpp"
#include "tests/params/support/random_parameters.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::params;

namespace {

std::string refusal(std::string_view key, std::string_view text) {
  UnitParameters parameters;
  const auto done = set(parameters, key, text);
  CHECK(parameters == UnitParameters{});
  REQUIRE_FALSE(done.has_value());
  CHECK(done.error().kind == ProblemKind::usage);
  return done.error().message;
}

}  // namespace

TEST_CASE("every parameter that thesis 5.3 lists is in the table under its thesis name") {
  std::string names;
  for (const Field& field : fields()) names += field.thesis_name + "\n";
  check_holds(names, {"number of machine axes",
                      "axes names (X,Y,Z)",
                      "axis configuration",
                      "machine measurement system (imperial or metric)",
                      "type of position transducer (encoder or resolver)",
                      "position feedback scaling factor",
                      "number of axis memory modules required",
                      "compensation required (linear, planar or volumetric)",
                      "compensation loop iteration time",
                      "minimum distance to qualify as move (encoder deadband)",
                      "compensation output value scaling factor",
                      "compensation polarity",
                      "angular scaling factor",
                      "squareness offsets",
                      "datum type (e.g. Fanuc, Allen Bradley, Siemens)",
                      "reference switch polarity",
                      "reference switch initial state",
                      "reference switch final state",
                      "reference switch approach speed",
                      "reference switch approach direction",
                      "null offset value"});
}

TEST_CASE("keys are unique, every field has help, and every default lies in its own range") {
  std::set<std::string> keys;
  for (const Field& field : fields()) {
    CAPTURE(field.key);
    CHECK(keys.insert(field.key).second);
    CHECK(field.help.size() > 20);
    CHECK(objection(field, UnitParameters{}) == "");
  }
}

TEST_CASE("the defaults of the unit are read as words and numbers") {
  CHECK(default_text(*field_named("configuration.chain")) == "TXYZ");
  CHECK(default_text(*field_named("configuration.axes")) == "XYZ");
  CHECK(default_text(*field_named("compensation.scope")) == "volumetric");
  CHECK(default_text(*field_named("compensation.plane")) == "XY");
  CHECK(default_text(*field_named("axis.Z.datum.kind")) == "fanuc");
  CHECK(default_text(*field_named("axis.Y.datum.approach_direction")) == "forward");
  CHECK(default_text(*field_named("axis.Y.datum.switch_finally_active")) == "false");
  CHECK(number_of(*field_named("axis.X.output_scale_counts_per_um"), UnitParameters{}) == 10.0);
}

TEST_CASE("setting a field changes that field alone") {
  UnitParameters parameters;
  REQUIRE(set(parameters, "axis.Y.deadband_um", "2.5 um"));
  REQUIRE(set(parameters, "axis.Z.datum.approach_direction", "reverse"));
  REQUIRE(set(parameters, "compensation.plane", "XZ"));
  REQUIRE(set(parameters, "axis.X.measurement_line_mm.y", "-1400"));
  REQUIRE(set(parameters, "compensation.tool_offset_mm.z", "-0.125"));
  REQUIRE(set(parameters, "configuration.axes", "XZ"));
  UnitParameters expected;
  expected.axes[1].deadband_um = 2.5;
  expected.axes[2].datum.approach_direction = Approach::reverse;
  expected.plane = {Axis::X, Axis::Z};
  expected.measurement_lines_mm[0][1] = -1400.0;
  expected.tool_offset_mm[2] = -0.125;
  expected.axis_present = {true, false, true};
  CHECK(parameters == expected);
}

TEST_CASE("a value out of range is refused with the range and its unit") {
  const std::string low = refusal("compensation.loop_period_us", "50");
  check_holds(low, {"compensation.loop_period_us", "100 to 20000 us", "50"});
  CHECK(contains(refusal("axis.X.position_scale_um_per_count", "0"), "except 0"));
  CHECK(contains(refusal("axis.X.compensation_polarity", "0"), "-1 or 1"));
  CHECK(contains(refusal("compensation.memory_modules", "1.5"), "1 to 5"));
  CHECK(contains(refusal("axis.X.datum.approach_speed_mm_min", "0"), "above 0"));
}

TEST_CASE("nan, inf, words and foreign units are no numbers") {
  for (const char* text : {"nan", "inf", "-inf", "much", "", "1e999", "2 mm", "2,5"})
    CHECK(contains(refusal("axis.X.deadband_um", text), "0 to 10000 um"));
}

TEST_CASE("a misspelt word is answered with the nearest choice, a misspelt key with the nearest key") {
  CHECK(contains(refusal("axis.X.transducer", "encodr"), "did you mean \"encoder\"?"));
  CHECK(contains(refusal("axis.X.transducer", "inductosyn"), "encoder or resolver"));
  CHECK(contains(refusal("compensation.scop", "linear"), "did you mean \"compensation.scope\"?"));
  CHECK(contains(refusal("axis.X.dedband_um", "2"), "did you mean \"axis.X.deadband_um\"?"));
}

TEST_CASE("a key without its table is answered with every full key that ends so") {
  CHECK(contains(refusal("deadband_um", "2"),
                 "\"axis.X.deadband_um\" or \"axis.Y.deadband_um\" or \"axis.Z.deadband_um\""));
}

TEST_CASE("a chain must have one T and different letters of XYZ") {
  for (const char* chain : {"", "XYZ", "TT", "TXX", "TXYZT", "TXW", "txyz", "T"})
    CHECK(contains(refusal("configuration.chain", chain), "the letter T and one to three of X, Y, Z"));
  for (const char* axes : {"", "XX", "XW", "T"})
    CHECK(contains(refusal("configuration.axes", axes), "one to three of X, Y, Z"));
}

TEST_CASE("text written from any field sets the same bits again") {
  CHECK(rc::check([] {
    const UnitParameters original = random_parameters();
    UnitParameters copy;
    for (const Field& field : fields()) RC_ASSERT(set_text(field, copy, text_of(field, original)).has_value());
    RC_ASSERT(same_bits(copy, original));
  }));
}

TEST_CASE("docs/parameters.md is the page written from the table (ECS_WRITE_DOCS=1 renews it)") {
  if (std::getenv("ECS_WRITE_DOCS") != nullptr) REQUIRE(write_file("docs/parameters.md", parameters_markdown()));
  CHECK(must(read_file("docs/parameters.md")) == parameters_markdown());
}

TEST_CASE("equal sets have no differences and no text") {
  CHECK(diff(UnitParameters{}, UnitParameters{}).empty());
  CHECK(to_text({}, "a", "b").empty());
}

TEST_CASE("differences name key, unit and both values in full") {
  UnitParameters a;
  UnitParameters b;
  b.axes[1].deadband_um = 0.1 + 0.2;
  b.scope = Scope::linear;
  const std::vector<Difference> expected{{"compensation.scope", "", "volumetric", "linear"},
                                         {"axis.Y.deadband_um", "um", "5", "0.30000000000000004"}};
  CHECK(diff(a, b) == expected);
  CHECK(to_text(diff(a, b), "disc", "unit") ==
        "                    disc        unit\n"
        "compensation.scope  volumetric  linear\n"
        "axis.Y.deadband_um  5 um        0.30000000000000004 um\n");
}

TEST_CASE("a change of any one field is found, and only that") {
  for (const Field& field : fields()) {
    if (field.type == FieldType::text) continue;
    CAPTURE(field.key);
    UnitParameters changed;
    const double other = field.get(changed) == field.most ? field.least : field.most;
    REQUIRE(set_number(field, changed, other));
    const auto found = diff(UnitParameters{}, changed);
    CHECK(only(found).key == field.key);
  }
}

TEST_CASE("applying the differences to the first set gives the second") {
  CHECK(rc::check([] {
    UnitParameters a = random_parameters();
    const UnitParameters b = random_parameters();
    for (const Difference& d : diff(a, b)) RC_ASSERT(set(a, d.key, d.b).has_value());
    RC_ASSERT(same_bits(a, b));
  }));
}

TEST_CASE("positions are shown in mm, or in inches of 25.4 mm where the parameters say imperial") {
  const PositionUnit& metric = position_unit(MeasurementSystem::metric);
  CHECK(metric.with_unit(254.0) == "254.0000 mm");
  CHECK(metric.speed_of(1200.0) == "1200.0");
  const PositionUnit& imperial = position_unit(MeasurementSystem::imperial);
  CHECK(imperial.with_unit(-254.0) == "-10.00000 in");
  CHECK(imperial.position(0.001) == "0.00004");
  CHECK(imperial.speed_of(2540.0) == "100.00");
  CHECK(imperial.speed == "in/min");
}
