// Rotary axes A, B, C in measurement sets, tables and statistics: targets in degrees, errors in um/m.
#include <numbers>

#include <fmt/format.h>

#include "laser/analysis/iso230.hpp"
#include "laser/import/import.hpp"
#include "laser/writers/writers.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

constexpr double kArcsec = 1e6 * std::numbers::pi / 180.0 / 3600.0;  // in um/m

ImportOptions of_rotary(ImportOptions options) {
  options.takes_rotary = true;
  return options;
}

MeasurementSet turned_set(const std::string& text, const ImportOptions& options, const std::string& name = "c.csv") {
  return must(parse_any(text, name, of_rotary(options))).set;
}

}  // namespace

TEST_CASE("a rotary axis in the measurement CSV is read and written back") {
  const std::string text = "axis,c_deg,sense,reading,approach,run\nC,0,EC,1,1,1\nC,360,EC,2.5,1,1\n";
  const auto set = turned_set(text, {});
  REQUIRE(set.readings.size() == 2);
  CHECK(set.readings[1].rotary);
  CHECK(set.readings[1].axis == Axis::Z);
  CHECK(target_of(set.readings[1]) == 360.0);
  CHECK(to_csv(set) == text);
  CHECK(curve_name(Sense::EC, Axis::Z, true) == "ECC");
  MeasurementSet bare;
  bare.readings = set.readings;
  CHECK(to_csv(bare).starts_with("axis,x_mm,y_mm,z_mm,sense,reading,approach,run,c_deg\nC,0,0,0,EC,1"));
  const auto lacks = parse_any("axis,c_deg,sense,reading\nC,,EC,1\n", "c.csv", of_rotary({}));
  CHECK(contains(lacks.error().message, "c_deg: expected the target position"));
}

TEST_CASE("work on linear axes refuses a rotary one, with its line and what takes it") {
  const auto refused = must_fail(parse_any("axis,a_deg,sense,reading\nA,0,EA,1\n", "a.csv", {}));
  CHECK(refused.line == 2);
  CHECK(
      contains(refused.message,
               "found the rotary axis A, which this command does not evaluate; use `ecs laser stats` and `ecs model`"));
}

TEST_CASE("work on lines refuses readings on a circle, and keeps a column path with other words") {
  const std::string head = "axis,x_mm,sense,reading,path\nX,0,EX,1,\n";
  const auto refused = must_fail(parse_any(head + "X,100,EX,1,circle XY radius 100 centre 0 0 0\n", "c.csv", {}));
  CHECK(refused.line == 3);
  CHECK(contains(refused.message, "found one on the path \"circle XY radius 100 centre 0 0 0\": use `ecs model`"));
  CHECK(parse_any(head + "X,100,EX,1,circles of friends\n", "c.csv", {}));
}

TEST_CASE("targets in degrees or arc seconds, readings in arc seconds") {
  const auto set = turned_set("0,0.5\n90,1.0\n", by_columns("b_deg=1,reading=2[arcsec]"));
  REQUIRE(set.readings.size() == 2);
  CHECK(set.readings[1].axis == Axis::Y);
  CHECK(set.readings[1].sense == Sense::EB);
  CHECK(target_of(set.readings[1]) == 90.0);
  CHECK(set.readings[1].error == Approx(kArcsec));
  const auto seconds = turned_set("0,1\n7200,1\n", by_columns("a_deg=1[arcsec],reading=2"));
  CHECK(target_of(seconds.readings[1]) == Approx(2.0));
}

TEST_CASE("actual angles become errors") {
  ImportOptions options = by_columns("c_deg=1,forward=2,reverse=3");
  options.mapping->values = TableValues::actual_positions;
  const auto set = turned_set("0 0.001 -0.001\n180 180.002 179.998\n", options);
  CHECK(set.readings[2].error == Approx(0.002 * 3600.0 * kArcsec));
  CHECK(set.readings[3].approach == Approach::reverse);
}

TEST_CASE("an instrument's file of a rotary axis: its targets are degrees") {
  ImportOptions options{.axis = Axis::X, .rotary = true, .sense = Sense::EA};
  const auto set = turned_set(sample_text("pitch.rta"), options, "pitch.rta");
  CHECK(set.readings.front().rotary);
  CHECK(set.readings[1].angle_deg[0] != set.readings[0].angle_deg[0]);
  CHECK(set.readings[1].position_mm[0] == 0.0);
  CHECK(says(set.notes, "targets read as deg of the rotary axis A"));
  options.sense = Sense::EX;
  CHECK_FALSE(parse_any(sample_text("vmc_x.rtl"), "x.rtl", of_rotary(options)).has_value());
}

TEST_CASE("statistics of a full turn: the targets that the standard asks for, and its closing") {
  std::string text = "axis,c_deg,sense,reading,approach,run\n";
  for (int run = 1; run <= 5; ++run)
    for (int k = 0; k <= 4; ++k) text += fmt::format("C,{},EC,{},1,{}\n", 90 * k, k + 0.1 * run, run);
  const auto set = turned_set(text, {});
  const Iso230 iso = must(iso230_of(set, only(groups_of(set))));
  CHECK(iso.rotary);
  CHECK(*iso.E_forward == Approx(4.0));
  CHECK(says(iso.notes, "5 targets on 360 deg; ISO 230-2 requires at least 8"));
  CHECK(says(iso.notes, "the readings at 0 and 360 deg, the same position, differ by +4 um/m"));
  CHECK_FALSE(says(iso.notes, "longer than 2000 mm"));
  CHECK_FALSE(says(iso.notes, "not a positioning error"));
}
