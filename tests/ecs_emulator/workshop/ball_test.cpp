// Readings of rotary axes in the emulated workshop: the exact chain against another writing of it
// (tests/support/exact_joints.hpp), and what the errors file may say of them.
#include <random>

#include "base/random.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "ecs_emulator/workshop/workshop.hpp"
#include "tests/support/exact_joints.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

constexpr const char* kErrors = R"(
[location]
XOC = 8.0
BOC = -12.0
[[effect]]
id = "location"
code = "YOA"
parameters = { um = 5.0 }
[[effect]]
id = "cyclic"
axis = "C"
parameters = { period_deg = 360.0, amplitude_um = 30.0 }
[[effect]]
id = "backlash"
axis = "C"
parameters = { um = 4.0 }
[[contribution]]
component = "EXC"
points = [[0, 0], [180, 6], [360, 0]]
[[contribution]]
component = "EAA"
formula = "0.1*p + d"
)";

Simulation trunnion(const std::string& errors, const char* machine = kTrunnion) {
  const WorkshopMachine description = machine_of(machine);
  TrueErrors read = errors_of(errors);
  if (const auto fits = read.checked_for(description.machine); !fits) FAIL(to_text(fits.error()));
  return {description, std::move(read), 1};
}

BallPlan ball_plan() { return {.ball_mm = {780.0, 330.0, -500.0}, .runs = 1, .noise_um = 0.0}; }

std::string refusal(const std::string& errors, const char* machine = kTrunnion) {
  auto read = TrueErrors::parse(errors, "errors.toml", {});
  if (!read) return to_text(read.error());
  const auto fits = read->checked_for(machine_of(machine).machine);
  return fits ? "" : to_text(fits.error());
}

}  // namespace

TEST_CASE("the emulated chain agrees with another writing of exact matrices to second order") {
  std::mt19937_64 random(9);
  UniformDraws uniform(-1.0, 1.0);
  for (const char* letters : {"XYACTZ", "XYBCTZ", "XTYZCB", "TXYZCA", "XYCTZB", "CXTYZB"}) {
    const std::string configuration = letters;
    CAPTURE(configuration);
    for (int trial = 0; trial < 20; ++trial) {
      TurningGeometry geometry;
      ecs::test::ExactMachine exact;
      std::string linear;
      for (const char letter : configuration)
        if (letter < 'A' || letter > 'C') linear += letter;
      geometry.configuration = exact.configuration = configuration;
      geometry.linear.chain = *chain_of(linear);
      ComponentValues components{};
      RotaryValues rotary;
      for (std::size_t c = 0; c < kCurves; ++c)
        exact.values.curve[c / 6][c % 6] = components[c] = 20.0 * uniform(random);
      for (std::size_t r = 0; r < kAxes; ++r) {
        params::MachineRotaryAxis axis;
        axis.direction[r] = 1.0;
        axis.pivot_mm = {200.0 * uniform(random), 200.0 * uniform(random), 200.0 * uniform(random)};
        geometry.rotary[r] = axis;
        exact.rotary[r] = {axis.direction, axis.pivot_mm};
        for (std::size_t s = 0; s < 6; ++s) {
          exact.values.curve[kAxes + r][s] = rotary.motion[r][s] = 20.0 * uniform(random);
          exact.location[r][s] = rotary.location[r][s] = 20.0 * uniform(random);
        }
      }
      geometry.linear.tool_offset_mm = exact.tool_offset_mm = {10.0, -20.0, -150.0};
      const Vector3 at{300.0 * uniform(random), 300.0 * uniform(random), 300.0 * uniform(random)};
      const Vector3 angles{90.0 * uniform(random), 90.0 * uniform(random), 180.0 * uniform(random)};
      const TurningPose pose = turning_pose(geometry, components, rotary, at, angles);
      const Vector3 expected = exact_tool_error(exact, at, angles).error_um;
      ecs::test::ExactMachine ideal = exact;
      ideal.values = {};
      ideal.location = {};
      const Eigen::Vector3d nominal = exact_pose(ideal, at, angles).translation();
      for (int d = 0; d < 3; ++d) {
        const auto i = static_cast<std::size_t>(d);
        CHECK(std::abs(pose.error_um[i] - expected[i]) < 0.02);  // of up to 60 um
        CHECK(pose.nominal_mm[i] == Approx(nominal[d]).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("the linear axes follow the ball, and a perfect machine reads nothing but where the ball is") {
  Simulation simulation = trunnion("");
  BallPlan plan = ball_plan();
  plan.off_um = {10.0, 0.0, -4.0};
  plan.sweeps = {*sweep_in("C=0:270:90")};
  const auto set = must(ball_readings(simulation, plan));
  REQUIRE(set.readings.size() == 4 * 2 * 3);
  for (const laser::Reading& r : set.readings) {
    CHECK(r.axis == Axis::Z);
    CHECK(r.rotary);
    CHECK(std::hypot(r.position_mm[0] - 600.0, r.position_mm[1] - 300.0) == Approx(std::hypot(180.0, 30.0)));
  }
  CHECK(set.readings[0].error == Approx(-10.0));
  CHECK(set.readings[2].error == Approx(4.0));
  // at C +90 the workpiece has turned by -90: its +X points along the machine's -Y
  CHECK(set.readings[3].error == Approx(0.0));
  CHECK(set.readings[4].error == Approx(10.0));
}

TEST_CASE("errors of rotary axes come from the errors file: place, direction, motions, effects by degrees") {
  const Simulation simulation = trunnion(kErrors);
  RotaryState state;
  state.angle_deg = {-60.0, 0.0, 90.0};
  const RotaryValues values = simulation.errors().rotary_at(state);
  CHECK(values.location[2][0] == 8.0);
  CHECK(values.location[2][4] == -12.0);
  CHECK(values.location[0][1] == 5.0);
  CHECK(values.motion[2][5] == Approx(30.0 + 2.0));
  CHECK(values.motion[2][0] == Approx(3.0));
  CHECK(values.motion[0][3] == Approx(-5.0));
  const RotaryComponents components = rotary_components(simulation, {{{-60.0}, {}, {0.0, 90.0}}});
  CHECK(components.forward[2][5][1] == Approx(32.0));
  CHECK(components.reverse[2][5][1] == Approx(28.0));
  CHECK(components.location[2][0] == 8.0);
}

TEST_CASE("an error motion on its own counts from its first target, there and back") {
  Simulation simulation = trunnion(kErrors);
  TurnPlan plan{.sweep = *sweep_in("C=0:270:90"), .runs = 1, .noise = 0.0};
  const auto set = must(turn_readings(simulation, plan));
  REQUIRE(set.readings.size() == 8);
  CHECK(set.readings[0].error == 0.0);
  CHECK(set.readings[1].error == Approx(30.0));
  CHECK(set.readings[7].error == Approx(-4.0));
  CHECK(set.readings[7].approach == Approach::reverse);
}

TEST_CASE("what no rotary axis can have is refused by its line") {
  CHECK(contains(refusal("[location]\nXOQ = 1.0\n"), "expected XOA … COC"));
  CHECK(contains(refusal("[location]\nXOB = 1.0\n"), "this machine has no rotary axis B"));
  CHECK(contains(refusal("[[effect]]\nid = \"sag\"\naxis = \"C\"\nparameters = { k2 = 1 }\n"),
                 "id: of a rotary axis expected offset, backlash, cyclic, step, time_drift or location"));
  CHECK(contains(refusal("[[effect]]\nid = \"location\"\ncode = \"BOC\"\nparameters = { um = 1 }\n"),
                 "expected parameters = { um_per_m = … }"));
  CHECK(contains(refusal("[[effect]]\nid = \"cyclic\"\naxis = \"C\"\nparameters = { period_mm = 10 }\n"), "period_mm"));
  const auto bends = [](const std::string& component, const std::string& what) {
    return refusal("[[contribution]]\ncomponent = \"" + component + "\"\nformula = \"p\"\nbends = \"" + what + "\"\n");
  };
  CHECK(contains(bends("EXA", "column"),
                 "bends: expected \"machine\" or \"tool\" of EX, EY or EZ, got \"column\" of EX"));
  CHECK(contains(bends("EBA", "tool"), "got \"tool\" of EB"));
  CHECK(contains(bends("EXA", "machine"), "bends: expected an axis on the tool side, A is on the workpiece side"));
}

TEST_CASE("a machine bends along its own axes, a tool by its length and in directions that the axis beneath turns") {
  const WorkshopMachine head = machine_of(R"(
name = "head"
configuration = "XTYZCB"
[axis.X]
travel_mm = [0.0, 100.0]
[axis.Y]
travel_mm = [0.0, 100.0]
[axis.Z]
travel_mm = [0.0, 100.0]
[axis.B]
travel_deg = [-100.0, 100.0]
pivot_mm = [0.0, 0.0, 300.0]
[axis.C]
travel_deg = [-180.0, 180.0]
pivot_mm = [0.0, 0.0, 300.0]
)");
  const auto error_um = [&](const std::string& bends, double tool_mm) {
    const TrueErrors errors =
        errors_of("[[contribution]]\ncomponent = \"EXB\"\nformula = \"20*sin(p*pi/180)\"\nbends = \"" + bends + "\"\n");
    RotaryState state;
    state.angle_deg = {0.0, 30.0, 90.0};
    return turning_pose(turning_geometry_of(head.machine, {0.0, 0.0, -tool_mm}), {}, errors.rotary_at(state), {},
                        state.angle_deg)
        .error_um;
  };
  for (const double tool_mm : {0.0, 200.0}) {
    const Vector3 of_machine = error_um("machine", tool_mm), of_tool = error_um("tool", tool_mm);
    CHECK(of_machine[0] == Approx(10.0));
    CHECK(of_machine[1] == Approx(0.0));
    CHECK(of_tool[0] == Approx(0.0));
    CHECK(of_tool[1] == Approx(10.0 * tool_mm / 1000.0));
  }
}

TEST_CASE("a sweep may be a list of angles; a set that follows begins from where the last one left the axes") {
  CHECK(sweep_in("A=-60,-10,20/C=90")->targets_deg == std::vector<double>{-60.0, -10.0, 20.0});
  Simulation simulation = trunnion("");
  const std::string answer = perform({&simulation, nullptr, nullptr},
                                     R"({"action": "ball", "ball": [780, 330, -500], "sweep": ["C=0,45,180/A=-10"]})");
  check_holds(answer, {"\"ok\":true"});
  CHECK(simulation.rotary().angle_deg == Vector3{-10.0, 0.0, 0.0});
  CHECK(simulation.rotary().approach[0] == Approach::reverse);
  CHECK(simulation.rotary().approach[2] == Approach::reverse);
}

TEST_CASE("a ball out of reach, an angle beyond the travel and a three-axis machine are refused with the reason") {
  Simulation simulation = trunnion("");
  BallPlan plan = ball_plan();
  plan.sweeps = {*sweep_in("A=-60:60:20")};
  CHECK(contains(to_text(ball_readings(simulation, plan).error()), "A 40 deg: expected an angle within its travel"));
  plan.sweeps = {*sweep_in("C=0:330:30/A=-100")};
  CHECK(contains(to_text(ball_readings(simulation, plan).error()), "beyond its travel"));
  CHECK(contains(to_text(sweep_in("C=0:330").error()), "sweep: expected such as"));
  Simulation plain(machine_of(ideal_machine()), errors_of(""), 1);
  CHECK(contains(to_text(ball_readings(plain, ball_plan()).error()), "expected a machine file with rotary axes"));
  const std::string answer =
      perform({&simulation, nullptr, nullptr}, R"({"action": "ball", "ball": [780, 330, -500]})");
  check_holds(answer, {"\"ok\":true", "a_deg"});
}
