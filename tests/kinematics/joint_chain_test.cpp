#include "kinematics/joint_chain.hpp"

#include "tests/support/test.hpp"

namespace ecs::kinematics {
namespace {

std::string order_of(const char* configuration) {
  std::string order;
  const JointChain chain = joint_chain_of(configuration).value();
  for (const ChainJoint& one : chain) {
    if (!one.carries_workpiece && order.find('|') == std::string::npos) order += '|';
    order += letter_of(one.joint);
  }
  return order;
}

TEST_CASE("a chain is walked from the workpiece over the bed to the tool") {
  CHECK(order_of("XYACTZ") == "CAYX|Z");
  CHECK(order_of("TXYZCB") == "|XYZCB");
  CHECK(order_of("XYCTZB") == "CYX|ZB");
}

TEST_CASE("ISO 10791 writes the same from the workpiece, with the bed") {
  CHECK(iso_notation(*joint_chain_of("XYACTZ")) == "w C' A' Y' X' b Z t");
  CHECK(iso_notation(*joint_chain_of("TXYZCB")) == "w b X Y Z C B t");
  CHECK(iso_notation(*joint_chain_of("XYZACT")) == "w C' A' Z' Y' X' b t");
}

TEST_CASE("the unit sees the chain without its rotary axes") {
  CHECK(linear_configuration("XYACTZ") == "XYTZ");
  CHECK(linear_configuration("TXYZ") == "TXYZ");
}

TEST_CASE("what is no chain is refused with what was expected") {
  CHECK(fault_of("XYUTZ") == "one T and different letters of XYZABC, such as \"XYACTZ\"");
  CHECK(fault_of("XYZAC") == "exactly one T: letters before it carry the workpiece, letters after it the tool");
  CHECK(fault_of("XTYTZ") == fault_of("XYZ"));
  CHECK(fault_of("XYACTZA") == "each letter once");
  CHECK(fault_of("XYABCTZ") == "at most two rotary axes of A, B, C");
  CHECK(fault_of("ACT") == "at least one linear axis of X, Y, Z");
  CHECK_FALSE(fault_of("XYACTZ").has_value());
  CHECK_FALSE(joint_chain_of("XYABCTZ").has_value());
}

}  // namespace
}  // namespace ecs::kinematics
