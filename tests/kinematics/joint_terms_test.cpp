// The general table against core's three-axis table: one rule, the same rows and the same sums.
#include "kinematics/joint_terms.hpp"

#include <random>

#include "base/random.hpp"
#include "kinematics/machine_pose.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/test.hpp"

namespace ecs::kinematics {
namespace {

TEST_CASE("chains of linear axes have the rows of the unit's table, in its order") {
  for (const std::string& configuration : test::every_chain())
    for (const CurveKind curves : {CurveKind::carriage, CurveKind::measured}) {
      CAPTURE(configuration);
      const TermTable ours = as_linear_terms(*joint_chain_of(configuration), curves);
      const TermTable unit = *ecs::terms_of(*chain_of(configuration), Convention::iso, curves);
      REQUIRE(ours.count == unit.count);
      for (std::size_t i = 0; i < unit.count; ++i) CHECK(ours.rows[i] == unit.rows[i]);
    }
}

TEST_CASE("with its rotary axes at 0 and without errors of theirs a machine errs as its linear axes do") {
  std::mt19937_64 random(11);
  UniformDraws any(-1.0, 1.0);
  for (const char* configuration : {"XYACTZ", "TXYZCB", "XCTYZB", "BXTYZ", "AXTBYZ"})
    for (const CurveKind curves : {CurveKind::carriage, CurveKind::measured}) {
      CAPTURE(configuration);
      JointMachine machine;
      machine.chain = *joint_chain_of(configuration);
      machine.terms = terms_of(machine.chain);
      machine.curves = curves;
      for (RotaryGeometry& axis : machine.rotary) axis.pivot_mm = {100.0 * any(random), 200.0 * any(random), 300.0};
      for (double& mm : machine.tool_offset_mm) mm = 150.0 * any(random);
      for (Vector3& line : machine.lines_mm)
        for (double& mm : line) mm = 400.0 * any(random);
      JointValues values;
      ComponentValues components{};
      for (std::size_t c = 0; c < kComponents; ++c) {
        components[c] = 50.0 * any(random);
        if (c < kCurves)
          values.curve[c / 6][c % 6] = components[c];
        else
          values.squareness[c] = components[c];
      }
      const Vector3 position_mm{700.0 * any(random), 500.0 * any(random), 400.0 * any(random)};
      const ToolError ours = tool_error(pose_at(machine, {}), values, position_mm);
      const auto terms = *ecs::terms_of(*chain_of(linear_configuration(configuration)), Convention::iso, curves);
      const Vector3 unit = tool_error_um(terms, components, position_mm, machine.lines_mm, machine.tool_offset_mm);
      for (std::size_t d = 0; d < kAxes; ++d) CHECK(ours.error_um[d] == doctest::Approx(unit[d]).epsilon(1e-12));
    }
}

TEST_CASE("a rotary axis has its six error motions, each rotation in two directions") {
  const JointTable table = terms_of(*joint_chain_of("XYACTZ"));
  CHECK(table.count == 45);
  CHECK(table.squareness_count == 3);
  std::size_t of_c = 0;
  for (std::size_t i = 0; i < table.count; ++i)
    if (table.rows[i].moving == Joint::C) ++of_c;
  CHECK(of_c == 9);
}

TEST_CASE("the lever of a rotary axis ends at the part that does not turn") {
  const JointChain chain = *joint_chain_of("XYACTZ");
  CHECK(is_beyond(chain, Joint::C, Joint::A, CurveKind::measured));  // workpiece side: its stator is A
  CHECK_FALSE(is_beyond(chain, Joint::C, Joint::C, CurveKind::measured));
  CHECK_FALSE(is_beyond(chain, Joint::A, Joint::C, CurveKind::measured));
  CHECK(is_beyond(*joint_chain_of("XYCTZB"), Joint::B, Joint::B, CurveKind::measured));  // tool side: it turns the tool
}

}  // namespace
}  // namespace ecs::kinematics
