#include "volume/rotary_errors.hpp"

#include <doctest/doctest.h>

#include "tests/support/test.hpp"

namespace ecs::volume {
namespace {

using doctest::Approx;
using kinematics::Joint;

kinematics::JointChain chain() { return *kinematics::joint_chain_of("XYACTZ"); }

std::string refused(std::string_view text) {
  const auto errors = parse_rotary_errors(text, "rotary.csv", chain());
  REQUIRE_FALSE(errors.has_value());
  return to_text(errors.error());
}

TEST_CASE("error motions go by angle and approach, location errors are constants added to them") {
  const auto errors = parse_rotary_errors(
      "component,approach,p_deg,error\n"
      "EAA,1,-90,4\nEAA,1,90,8\nEAA,-1,-90,0\nEAA,-1,90,-4\n"
      "XOC,,,12\nEXC,0,0,1\nEXC,0,90,2\nEXC,0,180,3\nEXC,0,270,2\n",
      "rotary.csv", chain());
  REQUIRE(errors.has_value());
  const auto forward = rotary_values(*errors, {0.0, 0.0, 45.0}, Approach::forward);
  CHECK(forward.curve[index_of(Joint::A)][3] == Approx(6.0));
  CHECK(forward.curve[index_of(Joint::C)][0] == Approx(13.5));
  CHECK(rotary_values(*errors, {0.0, 0.0, 45.0}, Approach::reverse).curve[index_of(Joint::A)][3] == Approx(-2.0));
}

TEST_CASE("a table round a whole turn closes, one of part of a turn keeps its end values") {
  const RotaryTable turn{Joint::C, Sense::EX, Approach::unknown, {0.0, 90.0, 180.0, 270.0}, {1.0, 2.0, 3.0, 2.0}, {}};
  CHECK(value_at(turn, 315.0) == Approx(1.5));
  CHECK(value_at(turn, -45.0) == Approx(1.5));
  CHECK(value_at(turn, 720.0) == Approx(1.0));
  const RotaryTable part{Joint::A, Sense::EX, Approach::unknown, {-30.0, 0.0, 30.0}, {1.0, 2.0, 5.0}, {}};
  CHECK(value_at(part, 80.0) == Approx(5.0));
  CHECK(value_at(part, -330.0) == Approx(1.0));
}

TEST_CASE("every wrong row of a file of rotary errors is reported with line, column and what was expected") {
  const std::string all = refused(
      "component,approach,p_deg,error\n"
      "EXD,1,0,1\nEXB,1,0,1\nEXC,2,0,1\nEXC,1,4000,1\nEXC,1,0,abc\nXOC,,10,1\nEXC,1,5,1\nEXC,1,5,2\n");
  CHECK(contains(all, "rotary.csv:2:1: component: expected an error of a rotary axis, such as EXC, EAB or XOC"));
  CHECK(contains(all,
                 "rotary.csv:3:1: component: expected an axis of the machine (w C' A' Y' X' b Z t), which has no B"));
  CHECK(contains(all, "rotary.csv:4:5: approach: expected 1, -1 or 0"));
  CHECK(contains(all, "rotary.csv:5:7: p_deg: expected an angle within 3600 deg of 0, found \"4000\""));
  CHECK(contains(all, "rotary.csv:6:9: error: expected a number"));
  CHECK(contains(all, "rotary.csv:7:6: p_deg: expected nothing"));
  CHECK(contains(all, "rotary.csv:9:7: p_deg: expected each angle once"));
  CHECK(contains(refused("component,approach,error\nEXC,1,1\n"), "p_deg"));
}

}  // namespace
}  // namespace ecs::volume
