// Rotary axes at the unit: their inputs, what a map with rotary axes needs, what isolates the unit, and what it adds.
#include <cmath>
#include <numbers>

#include "ecs_emulator/unit/unit.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// A tilting rotary table; `inputs` as lines of [axis.A] and [axis.C].
std::string table_machine(const std::string& input_a = "resolution_deg = 0.001\n",
                          const std::string& input_c = "resolution_deg = -0.0005\ntransducer_zero_deg = 30.0\n") {
  return ideal_machine("XYACTZ") + "[axis.A]\ntravel_deg = [-110.0, 30.0]\npivot_mm = [-250.0, -200.0, -280.0]\n" +
         input_a + "[axis.C]\ntravel_deg = [0.0, 360.0]\npivot_mm = [-250.0, -200.0, -280.0]\n" + input_c;
}

/// YOC, which the table turns with A, and lost motion of C along Z.
RotarySetup setup_of_table(const std::vector<std::uint8_t>& reverse, const std::vector<std::uint8_t>& forward) {
  RotarySetup setup{{'X', 'Y', 'A', 'C', 'T', 'Z'}, {}, {}};
  setup.axes[0] = {'A', 0.001, 0.005, {1.0, 0.0, 0.0}, {-250.0, -200.0, -280.0}, {}, 0.0};
  setup.axes[1] = {'C', -0.0005, 0.0025, {0.0, 0.0, 1.0}, {-250.0, -200.0, -280.0}, {0.0, 20.0}, 30.0};
  setup.tables[1] = {0.0, 10.0, 36, {0.01, 0.01, 0.01, 0.01, 0.01, 0.01}, {reverse, forward}};
  return setup;
}

struct TableBench : Bench {
  std::vector<std::uint8_t> reverse = std::vector<std::uint8_t>(12 * 36), forward = reverse;
  RotarySetup setup;

  explicit TableBench(const std::string& machine = table_machine()) : Bench("", machine) {
    for (std::size_t k = 0; k < 36; ++k) store_big(forward, 2 * (2 * 36 + k), std::uint16_t{500});  // EZC, 5 um
    setup = setup_of_table(reverse, forward);
    rotary = &setup;
  }
  void turn(double a_deg, double c_deg) {
    simulation.machine().turn_to({a_deg, 0.0, c_deg});
    REQUIRE(simulation.move_to(simulation.machine().command_mm(), 0.0));
  }
  [[nodiscard]] Vector3 compensation_um() {
    const auto sample = unit.monitor();
    return {sample.axes[0].compensation_um, sample.axes[1].compensation_um, sample.axes[2].compensation_um};
  }
  void check_compensation(double x_um, double y_um, double z_um) {
    const Vector3 um = compensation_um();
    CHECK(um[0] == Approx(x_um).epsilon(1e-4));
    CHECK(um[1] == Approx(y_um).epsilon(1e-4));
    CHECK(um[2] == Approx(z_um).epsilon(1e-4));
  }
};

}  // namespace

TEST_CASE("the unit turns the errors of a rotary axis with the axis that carries it, at the angles of its inputs") {
  TableBench b;
  b.compensate();
  b.check_compensation(0.0, -20.0, 5.0);  // YOC 20 um, EZC forward: as after referencing
  b.turn(0.0, 120.0);
  b.check_compensation(0.0, -20.0, 5.0);
  b.turn(0.0, 90.0);
  b.check_compensation(0.0, -20.0, 0.0);
  b.turn(0.0, 90.001);  // within the deadband
  b.check_compensation(0.0, -20.0, 0.0);
  const double c = std::cos(std::numbers::pi / 6), s = 0.5;
  b.turn(-30.0, 90.0);  // the table turns the workpiece the other way
  b.check_compensation(0.0, -20.0 * c, 20.0 * -s);
  CHECK(b.unit.mode() == UnitMode::compensating);
  CHECK(b.unit.fault() == Fault::none);
}

TEST_CASE("the unit shows the angles of the rotary axes of its map, and while it compensates what they add") {
  TableBench b;
  CHECK_FALSE(any_axis(b.unit.rotary()));
  REQUIRE(b.stage_and_commit(b.flat_image(0.0)).state == CommandState::done);
  b.turn(-30.0, 90.0);
  b.simulation.tick();  // the inputs of the period after the motion
  protocol::RotarySample shown = b.unit.rotary();
  CHECK(shown.compensation_um == Vector3{});
  CHECK(shown.axes[0] == protocol::RotaryAxisSample{'A', true, -30.0, Approach::unknown});
  CHECK(shown.axes[1].letter == 'C');
  CHECK(shown.axes[1].angle_deg == Approx(90.0));
  b.compensate([](Component c, double, Approach) { return c == Component::EXX ? 7.0 : 0.0; });
  b.turn(-30.0, 89.0);
  shown = b.unit.rotary();
  CHECK(shown.axes[0].approach == Approach::forward);
  CHECK(shown.axes[1].angle_deg == Approx(89.0));
  CHECK(shown.axes[1].approach == Approach::reverse);
  const Vector3 all_um = b.compensation_um();
  CHECK(shown.compensation_um[1] == Approx(-20.0 * std::cos(std::numbers::pi / 6)).epsilon(1e-4));
  for (std::size_t i = 0; i < kAxes; ++i) CHECK(all_um[i] - shown.compensation_um[i] == Approx(i == 0 ? 7.0 : 0.0));
  b.simulation.machine().rotary(2).lose_transducer(true);
  b.simulation.tick();
  CHECK(b.unit.rotary().axes[1] == protocol::RotaryAxisSample{'C', false, 0.0, Approach::unknown});
}

TEST_CASE("a map with rotary axes is refused by a unit without their inputs, and the old map stays") {
  TableBench b(table_machine("resolution_deg = 0.001\n", ""));
  const auto refused = b.stage_and_commit(b.flat_image(0.0));
  CHECK(refused.state == CommandState::refused);
  CHECK(refused.error == UnitError::image_refused);
  CHECK(refused.text == "this rack has no input for axis C");
  b.rotary = nullptr;
  CHECK(b.stage_and_commit(b.flat_image(0.0)).state == CommandState::done);
}

TEST_CASE("a unit that finds the input of a rotary axis gone does not compensate: axis_module, with the letter") {
  TableBench b;
  REQUIRE(b.stage_and_commit(b.flat_image(0.0)).state == CommandState::done);
  b.unit.turned({});
  b.simulation.attach(nullptr);
  CommandResult entered = b.unit.begin({.code = CommandCode::enter_compensation});
  (void)b.unit.tick({});
  entered = b.unit.progress();
  CHECK(entered.state == CommandState::failed);
  CHECK(b.unit.fault() == Fault::axis_module);
  CHECK(b.unit.status().fault_address == 'A');
  CHECK_FALSE(b.unit.status().fault_axis);
  CHECK(b.unit.mode() == UnitMode::integration);
}

TEST_CASE("a lost rotary transducer isolates the unit while it compensates, and while it waits for referencing") {
  TableBench b;
  b.compensate();
  REQUIRE(all_relays(b, true));
  b.simulation.machine().rotary(2).lose_transducer(true);
  b.simulation.tick();
  CHECK(b.unit.fault() == Fault::axis_module);
  CHECK(b.unit.status().fault_address == 'C');
  CHECK(b.unit.mode() == UnitMode::integration);
  CHECK(all_relays(b, false));
  REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
  b.simulation.tick();
  CHECK(b.unit.mode() == UnitMode::integration);
  b.simulation.machine().rotary(2).lose_transducer(false);
  REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
  b.reference_all();
  CHECK(b.unit.mode() == UnitMode::compensating);
}

TEST_CASE("a jump of a rotary axis that no axis can make isolates the unit") {
  TableBench b;
  b.compensate();
  RotaryWires wires = b.simulation.machine().rotary_wires();
  b.unit.turned(wires);
  wires[0]->counts += 3500;  // 3.5 deg in a period of 1 ms
  b.unit.turned(wires);
  (void)b.unit.tick(b.simulation.machine().signals());
  CHECK(b.unit.mode() == UnitMode::compensating);
  wires[0]->counts += 3700;
  b.unit.turned(wires);
  (void)b.unit.tick(b.simulation.machine().signals());
  CHECK(b.unit.fault() == Fault::position_jump);
  CHECK(b.unit.status().fault_address == 'A');
  CHECK(b.unit.mode() == UnitMode::integration);
}

TEST_CASE("a map without rotary axes after one with two needs their inputs no more") {
  TableBench b;
  b.compensate();
  REQUIRE(b.tell(CommandCode::enter_integration).state == CommandState::done);
  b.rotary = nullptr;
  b.compensate();
  b.unit.turned({});
  (void)b.unit.tick(b.simulation.machine().signals());
  CHECK(b.unit.mode() == UnitMode::compensating);
  CHECK(b.unit.fault() == Fault::none);
}

TEST_CASE("rotary axes that do not go with the parameters are a map that is not for them") {
  TableBench b;
  b.parameters.interpolation = Interpolation::nearest;
  REQUIRE(b.stage_and_commit(b.flat_image(0.0)).state == CommandState::done);
  CHECK(b.tell(CommandCode::enter_compensation).state == CommandState::failed);
  CHECK(b.unit.fault() == Fault::map_not_for_parameters);
}
