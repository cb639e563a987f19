// Nominal forward kinematics against the modules of LinuxCNC as Debian ships them. Ours turn the tool against the
// workpiece, right-handed (ISO 841); each module says in its case which of its axes run the other way.
#include <random>

#include "base/random.hpp"
#include "kinematics/machine_pose.hpp"
#include "tests/kinematics/support/linuxcnc_kinematics.hpp"
#include "tests/support/test.hpp"

namespace ecs::kinematics {
namespace {

using test::LinuxcncKinematics;

constexpr double kRounding_mm = 1e-9;
constexpr int kPoses = 500;

/// Which joint of LinuxCNC is which rotary axis, and its direction: 1 as ours, −1 reversed.
struct RotaryJoint {
  Joint joint = Joint::A;
  std::size_t number = 3;
  double direction = 1.0;
};

JointMachine machine_of(const char* configuration) {
  JointMachine machine;
  machine.chain = *joint_chain_of(configuration);
  machine.terms = terms_of(machine.chain);
  machine.rotary = {{{{1.0, 0.0, 0.0}, {}}, {{0.0, 1.0, 0.0}, {}}, {{0.0, 0.0, 1.0}, {}}}};
  return machine;
}
RotaryGeometry& rotary(JointMachine& machine, Joint joint) { return machine.rotary[index_of(joint) - kAxes]; }

/// Largest distance between both tool points over random poses [mm].
double largest_difference(const LinuxcncKinematics& linuxcnc, const JointMachine& machine,
                          const std::vector<RotaryJoint>& axes, const Vector3& shift_mm = {}) {
  std::mt19937_64 random(31);
  UniformDraws any(-1.0, 1.0);
  double largest = 0.0;
  for (int pose = 0; pose < kPoses; ++pose) {
    std::array<double, 9> joints{500.0 * any(random), 400.0 * any(random), 300.0 * any(random)};
    const Vector3 position_mm{joints[0], joints[1], joints[2]};
    Angles angles_deg{};
    for (const RotaryJoint& axis : axes) {
      joints[axis.number] = 180.0 * any(random);
      angles_deg[index_of(axis.joint) - kAxes] = axis.direction * joints[axis.number];
    }
    const Vector3 theirs = linuxcnc.forward(joints).xyz_mm;
    const Vector3 ours = pose_at(machine, angles_deg).tool_mm.at(position_mm);
    for (std::size_t d = 0; d < kAxes; ++d) largest = std::max(largest, std::abs(ours[d] + shift_mm[d] - theirs[d]));
  }
  return largest;
}

/// The directions of both axes that agree, of the four possible: the other three do not.
std::vector<std::array<double, 2>> directions_that_agree(const LinuxcncKinematics& linuxcnc,
                                                         const JointMachine& machine, std::vector<RotaryJoint> axes,
                                                         const Vector3& shift_mm = {}) {
  std::vector<std::array<double, 2>> agree;
  for (const double first : {1.0, -1.0})
    for (const double second : {1.0, -1.0}) {
      axes[0].direction = first;
      axes[1].direction = second;
      if (largest_difference(linuxcnc, machine, axes, shift_mm) < kRounding_mm) agree.push_back({first, second});
    }
  return agree;
}

using Directions = std::vector<std::array<double, 2>>;
constexpr const char* kMissing = "LinuxCNC's module is not installed (package linuxcnc-uspace)";

/// Where the axes of a table lie, the offsets between them, and the tool.
void set_table(const LinuxcncKinematics& linuxcnc, const char* offset, const char* tool) {
  for (const auto& [pin, value] : {std::pair{"x-rot-point", 31.0}, {"y-rot-point", -47.0}, {"z-rot-point", -213.0}})
    REQUIRE(linuxcnc.set(pin, value));
  for (const auto& [pin, value] : {std::pair{offset, 20.0}, {"z-offset", 35.0}, {tool, 90.0}})
    REQUIRE(linuxcnc.set(pin, value));
}

TEST_CASE("5axiskins, C and B in the head: B is reversed, C is not") {
  const auto linuxcnc = LinuxcncKinematics::load("5axiskins");
  SKIP_UNLESS(linuxcnc, kMissing);
  REQUIRE(linuxcnc->set("pivot-length", 237.0));
  JointMachine machine = machine_of("TXYZCB");
  rotary(machine, Joint::B).pivot_mm = rotary(machine, Joint::C).pivot_mm = {0.0, 0.0, 237.0};
  CHECK(directions_that_agree(*linuxcnc, machine, {{Joint::B, 3}, {Joint::C, 4}}) == Directions{{-1.0, 1.0}});
}

TEST_CASE("maxkins, B in the head and C under the workpiece: B is reversed, as its source says, C is not") {
  const auto linuxcnc = LinuxcncKinematics::load("maxkins");
  SKIP_UNLESS(linuxcnc, kMissing);
  REQUIRE(linuxcnc->set("pivot-length", 112.0));
  JointMachine machine = machine_of("XYCTZB");
  rotary(machine, Joint::B).pivot_mm = {0.0, 0.0, 112.0};
  for (const double reversed : {1.0, -1.0}) {
    const bool b_agrees = largest_difference(*linuxcnc, machine, {{Joint::B, 4, reversed}}) < kRounding_mm;
    const bool c_agrees = largest_difference(*linuxcnc, machine, {{Joint::C, 5, reversed}}) < kRounding_mm;
    CHECK(b_agrees == (reversed < 0.0));
    CHECK(c_agrees == (reversed > 0.0));
  }
}

TEST_CASE(
    "maxkins does not turn the tilt of its head with the table: with both angles it is no chain of rigid bodies") {
  const auto linuxcnc = LinuxcncKinematics::load("maxkins");
  SKIP_UNLESS(linuxcnc, kMissing);
  REQUIRE(linuxcnc->set("pivot-length", 112.0));
  JointMachine machine = machine_of("XYCTZB");
  rotary(machine, Joint::B).pivot_mm = {0.0, 0.0, 112.0};
  const double b_deg = 30.0, c_deg = 50.0;
  const Vector3 ours = pose_at(machine, {0.0, -b_deg, c_deg}).tool_mm.at({100.0, 200.0, 300.0});
  const Vector3 tilt = pose_at(machine, {0.0, -b_deg, 0.0}).tool_mm.at({});
  const Vector3 turned_tilt = turned(tilt, {0.0, 0.0, 1.0}, c_deg);
  const Vector3 theirs = linuxcnc->forward({100.0, 200.0, 300.0, 0.0, b_deg, c_deg}).xyz_mm;
  for (std::size_t d = 0; d < kAxes; ++d) CHECK(theirs[d] == Approx(ours[d] - turned_tilt[d] + tilt[d]));
}

TEST_CASE("xyzac-trt-kins, C on a tilting table A: both are reversed") {
  const auto linuxcnc = LinuxcncKinematics::load("xyzac-trt-kins");
  SKIP_UNLESS(linuxcnc, kMissing);
  set_table(*linuxcnc, "y-offset", "tool-offset");
  JointMachine machine = machine_of("XYACTZ");
  machine.tool_offset_mm = {0.0, 0.0, -90.0};
  rotary(machine, Joint::A).pivot_mm = {0.0, -47.0 + 20.0, -213.0 + 35.0};
  rotary(machine, Joint::C).pivot_mm = {31.0, -47.0, 0.0};
  const Vector3 tool_mm{0.0, 0.0, 90.0};  // LinuxCNC's Z goes on counting the spindle at angles of 0
  CHECK(directions_that_agree(*linuxcnc, machine, {{Joint::A, 3}, {Joint::C, 4}}, tool_mm) == Directions{{-1.0, -1.0}});
}

TEST_CASE("xyzbc-trt-kins, C on a tilting table B: both are reversed") {
  const auto linuxcnc = LinuxcncKinematics::load("xyzbc-trt-kins");
  SKIP_UNLESS(linuxcnc, kMissing);
  set_table(*linuxcnc, "x-offset", "tool-offset");
  JointMachine machine = machine_of("XYBCTZ");
  machine.tool_offset_mm = {0.0, 0.0, -90.0};
  rotary(machine, Joint::B).pivot_mm = {31.0 + 20.0, 0.0, -213.0 + 35.0};
  rotary(machine, Joint::C).pivot_mm = {31.0, -47.0, 0.0};
  const Vector3 tool_mm{0.0, 0.0, 90.0};
  CHECK(directions_that_agree(*linuxcnc, machine, {{Joint::B, 3}, {Joint::C, 4}}, tool_mm) == Directions{{-1.0, -1.0}});
}

TEST_CASE("xyzab_tdr_kins, A on a table B: neither is reversed") {
  const auto linuxcnc = LinuxcncKinematics::load("xyzab_tdr_kins");
  SKIP_UNLESS(linuxcnc, kMissing);
  linuxcnc->switch_to(1);  // 0 is the identity
  set_table(*linuxcnc, "x-offset", "tool-offset-z");
  JointMachine machine = machine_of("XYBATZ");
  machine.tool_offset_mm = {0.0, 0.0, -90.0};
  rotary(machine, Joint::B).pivot_mm = {31.0, 0.0, -213.0};
  rotary(machine, Joint::A).pivot_mm = {0.0, -47.0, -213.0 + 35.0};
  const Vector3 tool_mm{0.0, 0.0, 90.0};
  CHECK(directions_that_agree(*linuxcnc, machine, {{Joint::A, 3}, {Joint::B, 4}}, tool_mm) == Directions{{1.0, 1.0}});
}

}  // namespace
}  // namespace ecs::kinematics
