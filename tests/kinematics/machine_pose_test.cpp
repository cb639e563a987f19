// Chains with rotary axes; the general table against core's three-axis table: one rule, the same rows and the same
// sums; what an error component does at the tool of a machine whose rotary axes stand at angles.
#include "kinematics/machine_pose.hpp"

#include <random>
#include <tuple>

#include "base/random.hpp"
#include "tests/support/exact_joints.hpp"
#include "tests/support/random_values.hpp"

namespace ecs::kinematics {
namespace {

std::string order_of(const char* configuration) {
  std::string order;
  const JointChain chain = joint_chain_of(configuration).value();
  for (const ChainJoint& one : chain) {
    if (!one.carries_workpiece && !contains(order, '|')) order += '|';
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
  CHECK(fault_of("XYUTZ") == "the letter T and letters of X, Y, Z, A, B, C, each once, such as \"XYACTZ\"");
  CHECK(fault_of("XYZAC") ==
        "exactly one T: letters before it are on the workpiece side, letters after it on the tool side");
  CHECK(fault_of("XTYTZ") == fault_of("XYZ"));
  CHECK(fault_of("XYACTZA") == "each letter once");
  CHECK(fault_of("XYABCTZ") == "at most two rotary axes of A, B, C");
  CHECK(fault_of("ACT") == "at least one linear axis of X, Y, Z");
  CHECK_FALSE(fault_of("XYACTZ").has_value());
  CHECK_FALSE(joint_chain_of("XYABCTZ").has_value());
}

/// The table in core's form. @pre no rotary axis in `chain`
TermTable as_linear_terms(const JointChain& chain, CurveKind curves) {
  TermTable out;
  const JointTable table = terms_of(chain);
  for (std::size_t i = 0; i < table.count; ++i) {
    const JointTerm& row = table.rows[i];
    out.rows[out.count++] = {row.observed,
                             curve_of(row.sense, direction_of(row.moving)),
                             row.has_lever,
                             row.lever,
                             row.has_lever && is_beyond(chain, row.moving, joint_of(row.lever), curves),
                             row.sign};
  }
  for (std::size_t i = 0; i < table.squareness_count; ++i) {
    const SquarenessTerm& row = table.squareness[i];
    out.rows[out.count++] = {row.observed, row.component, true, row.lever, true, row.sign};
  }
  return out;
}

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
      for (std::size_t d = 0; d < kAxes; ++d) CHECK(ours.error_um[d] == Approx(unit[d]).epsilon(1e-12));
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

struct Case {
  test::ExactMachine exact;
  JointMachine machine;
  JointValues values;
  Vector3 position_mm{};
  Angles angles_deg{};
};

/// @param size  1: straightness to 40 um, angles to 60 um/m, squareness and location to 50
Case case_of(const std::string& configuration, double size, std::mt19937_64& random) {
  UniformDraws any(-1.0, 1.0);
  const auto vector = [&](double most) { return Vector3{most * any(random), most * any(random), most * any(random)}; };
  Case made;
  made.machine.chain = *joint_chain_of(configuration);
  made.machine.terms = terms_of(made.machine.chain);
  for (std::size_t r = 0; r < kAxes; ++r) {
    RotaryGeometry& axis = made.machine.rotary[r];
    axis.pivot_mm = vector(300.0);
    axis.direction = {};
    axis.direction[r] = 1.0;
    if (any(random) > 0.0) {  // an oblique axis, as of a nutating head
      axis.direction = vector(1.0);
      const double length = std::hypot(axis.direction[0], axis.direction[1], axis.direction[2]);
      for (double& part : axis.direction) part /= length;
    }
  }
  for (Vector3& line : made.machine.lines_mm) line = vector(300.0);
  for (std::size_t l = 0; l < kAxes; ++l) made.machine.lines_mm[l][l] = 0.0;
  made.machine.tool_offset_mm = vector(150.0);
  made.exact = {configuration, made.machine.rotary, made.machine.lines_mm, made.machine.tool_offset_mm, {}, {}};
  for (const ChainJoint& one : made.machine.chain) {
    const std::size_t j = index_of(one.joint);
    for (std::size_t s = 0; s < 6; ++s) {
      made.exact.values.curve[j][s] = (s < kAxes ? 40.0 : 60.0) * size * any(random);
      if (is_rotary(one.joint)) made.exact.location[j - kAxes][s] = 50.0 * size * any(random);
    }
  }
  for (const auto& [component, first, second] :
       {std::tuple{Component::C0Y, Joint::X, Joint::Y}, std::tuple{Component::B0Z, Joint::X, Joint::Z},
        std::tuple{Component::A0Z, Joint::Y, Joint::Z}}) {
    const double value = 50.0 * size * any(random);
    if (made.machine.chain.has(first) && made.machine.chain.has(second))
      made.exact.values.squareness[ecs::index_of(component)] = value;
  }
  made.values = made.exact.values;
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < 6; ++s) made.values.curve[kAxes + r][s] += made.exact.location[r][s];
  for (std::size_t l = 0; l < kAxes; ++l)
    made.position_mm[l] = made.machine.chain.has(static_cast<Joint>(l)) ? 900.0 * any(random) : 0.0;
  for (double& angle : made.angles_deg) angle = 180.0 * any(random);
  return made;
}

struct Difference {
  double position_um = 0.0, orientation_um_per_m = 0.0, largest_um = 0.0;
};

/// Over some places of a machine.
Difference difference_of(const std::string& configuration, double size) {
  std::mt19937_64 random(std::hash<std::string>{}(configuration));
  Difference most;
  for (int place = 0; place < 3; ++place) {
    const Case made = case_of(configuration, size, random);
    const ToolError found = tool_error(pose_at(made.machine, made.angles_deg), made.values, made.position_mm);
    const ToolError exact = test::exact_tool_error(made.exact, made.position_mm, made.angles_deg);
    for (std::size_t d = 0; d < kAxes; ++d) {
      most.position_um = std::max(most.position_um, std::abs(found.error_um[d] - exact.error_um[d]));
      most.orientation_um_per_m =
          std::max(most.orientation_um_per_m, std::abs(found.orientation_um_per_m[d] - exact.orientation_um_per_m[d]));
      most.largest_um = std::max(most.largest_um, std::abs(exact.error_um[d]));
    }
  }
  return most;
}

TEST_CASE("error and orientation agree with exact matrices to second order on every chain with rotary axes") {
  double largest_um = 0.0, difference_um = 0.0, worst_ratio = 0.0;
  std::size_t chains = 0;
  for (const std::string& configuration : test::every_rotary_chain()) {
    CAPTURE(configuration);
    const Difference whole = difference_of(configuration, 1.0), half = difference_of(configuration, 0.5);
    CHECK(whole.position_um < 0.3);
    CHECK(half.position_um < whole.position_um / 3.5 + 1e-6);  // a quarter, were it of second order alone
    CHECK(whole.orientation_um_per_m < 0.1);
    CHECK(half.orientation_um_per_m < whole.orientation_um_per_m / 3.5 + 1e-6);
    largest_um = std::max(largest_um, whole.largest_um);
    difference_um = std::max(difference_um, whole.position_um);
    worst_ratio = std::max(worst_ratio, half.position_um / whole.position_um);
    ++chains;
  }
  MESSAGE(chains << " chains, errors to " << largest_um << " um, difference to " << difference_um
                 << " um, of half the errors at most " << worst_ratio << " of it");
  CHECK(chains > 3000);
}

TEST_CASE("the nominal tool point is that of the exact matrices") {
  for (const char* configuration : {"XYACTZ", "TXYZCB", "XYCTZB", "CXTYBZ"}) {
    std::mt19937_64 random(5);
    Case made = case_of(configuration, 0.0, random);
    const Eigen::Isometry3d exact = exact_pose(made.exact, made.position_mm, made.angles_deg);
    const Vector3 found = pose_at(made.machine, made.angles_deg).tool_mm.at(made.position_mm);
    for (std::size_t d = 0; d < kAxes; ++d)
      CHECK(found[d] == Approx(exact.translation()[static_cast<Eigen::Index>(d)]).epsilon(1e-12));
  }
}

TEST_CASE("a table whose axis lies 10 um aside errs as it turns") {
  JointMachine machine;
  machine.chain = *joint_chain_of("XYCTZ");
  machine.terms = terms_of(machine.chain);
  JointValues values;
  values.curve[index_of(Joint::C)][0] = 10.0;  // XOC
  const auto at = [&](double angle_deg) {
    return tool_error(pose_at(machine, {0.0, 0.0, angle_deg}), values, {100.0, 0.0, 0.0}).error_um;
  };
  CHECK(at(0.0)[0] == Approx(10.0));
  CHECK(at(90.0)[1] == Approx(10.0));  // the workpiece has turned: its Y is along the machine's X
  CHECK(at(180.0)[0] == Approx(-10.0));
}

TEST_CASE("an error of angular position moves the tool by its distance from the axis") {
  JointMachine machine;
  machine.chain = *joint_chain_of("XYCTZ");
  machine.terms = terms_of(machine.chain);
  machine.rotary[2].pivot_mm = {300.0, 200.0, 0.0};
  JointValues values;
  values.curve[index_of(Joint::C)][5] = 20.0;  // ECC, um/m
  const ToolError error = tool_error(pose_at(machine, {}), values, {800.0, 200.0, 0.0});
  CHECK(error.error_um[1] == Approx(10.0));
  CHECK(error.orientation_um_per_m[2] == Approx(20.0));
}

}  // namespace
}  // namespace ecs::kinematics
