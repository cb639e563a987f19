// Tools and the wires from the control: the table in the unit, a change while it compensates, numbers that nobody
// knows, the control's "power on", and the file of the battery.
#include "core/tools.hpp"

#include <cmath>
#include <filesystem>

#include "ecs_emulator/part_programs/run.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"
#include "tests/support/folder.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

constexpr const char* kTurns = R"x(
[[contribution]]
component = "EBX"
formula = "60*sin(p/90)"
[[contribution]]
component = "EAY"
formula = "40*cos(p/70)"
[[contribution]]
component = "ECZ"
formula = "-50*sin(p/50)"
)x";

/// A machine whose rotations act through three tools of its magazine; the control's wires lead to the unit.
std::string machine_with_tools(bool wired = true) {
  return ideal_machine() + (wired ? "[emulator]\ntool_wires = true\npower_on_wire = true\n" : "") + R"(
[[emulator.tool]]
number = 1
z_mm = -80.0
[[emulator.tool]]
number = 2
z_mm = -250.0
[[emulator.tool]]
number = 30
x_mm = 60.0
y_mm = -20.0
z_mm = -180.0
)";
}

CommandResult put_into_table(Bench& bench, std::uint16_t number, const Vector3& offset_mm) {
  return bench.tell(Command{.code = CommandCode::set_tool, .tool = number, .tool_offset_mm = offset_mm});
}
CommandResult select_tool(Bench& bench, std::uint16_t number) {
  return bench.tell(Command{.code = CommandCode::select_tool, .tool = number});
}

/// The whole table, as a host replaces it. @param more  tools that it states beside those it sends
CommandResult replace_table(Bench& bench, const std::vector<Tool>& tools, std::uint32_t more = 0) {
  ToolTable table;
  REQUIRE(bench.tell(CommandCode::begin_tools).state == CommandState::done);
  for (const Tool& tool : tools) {
    const Command one{.code = CommandCode::stage_tool, .tool = tool.number, .tool_offset_mm = tool.offset_mm};
    REQUIRE(bench.tell(one).state == CommandState::done);
    REQUIRE(put_tool(table, tool));
  }
  return bench.tell(Command{.code = CommandCode::commit_tools,
                            .length = static_cast<std::uint32_t>(tools.size()) + more,
                            .digest = protocol::tools_digest(table)});
}

double compensation_of(Component component, double position_mm, Approach) {
  if (component == Component::EBX) return -60.0 * std::sin(position_mm / 90.0);
  if (component == Component::EAY) return -40.0 * std::cos(position_mm / 70.0);
  if (component == Component::ECZ) return 50.0 * std::sin(position_mm / 50.0);
  return 0.0;
}

/// Compensating, with the three tools in its table.
struct ToolBench : Bench {
  explicit ToolBench(bool wired = true) : Bench(kTurns, machine_with_tools(wired)) {
    parameters.tool_range_mm = {100.0, 100.0, 300.0};
    for (AxisParameters& axis : parameters.axes) axis.output_limit_um = 1000.0;
  }
  void begin() {
    compensate(compensation_of);
    for (const MagazineTool& tool : simulation.description().settings.tools)
      REQUIRE(put_into_table(*this, tool.number, tool.offset_mm).state == CommandState::done);
  }
  [[nodiscard]] double error_um() {
    const ToolPose pose = simulation.tool_now(false);
    double largest = 0.0;
    for (const double um : pose.error_um) largest = std::max(largest, std::abs(um));
    return largest;
  }
  [[nodiscard]] Vector3 compensation_um() {
    const auto sample = unit.monitor();
    return {sample.axes[0].compensation_um, sample.axes[1].compensation_um, sample.axes[2].compensation_um};
  }
  /// The largest change of the compensation of an axis in one period, over these periods.
  double largest_step_um(int periods) {
    double largest = 0.0;
    Vector3 before_um = compensation_um();
    for (int k = 0; k < periods; ++k) {
      simulation.tick();
      const Vector3 now_um = compensation_um();
      for (std::size_t a = 0; a < kAxes; ++a) largest = std::max(largest, std::abs(now_um[a] - before_um[a]));
      before_um = now_um;
    }
    return largest;
  }
};

}  // namespace

TEST_CASE("the control changes the tool while the unit compensates: no axis steps, and the new tool is right") {
  ToolBench b;
  b.begin();
  double largest_step_um = 0.0, largest_error_um = 0.0, without_um = 0.0;
  for (const int n : {1, 2, 30, 2, 0, 30, 1}) {
    const auto number = static_cast<std::uint16_t>(n);
    REQUIRE(b.simulation.move_to({-60.0 - 10.0 * number, -210.0, -140.0 + number}, 0.0));
    REQUIRE(b.simulation.dwell(1.0));
    const Vector3 before_um = b.simulation.tool_now(false).error_um;
    b.simulation.change_tool(number);
    for (std::size_t a = 0; a < kAxes; ++a)
      without_um = std::max(without_um, std::abs(b.simulation.tool_now(false).error_um[a] - before_um[a]));
    largest_step_um = std::max(largest_step_um, b.largest_step_um(3000));
    CHECK(b.unit.control_lines().tool == number);
    CHECK(b.unit.control_lines().tool_state == (number == 0 ? protocol::ToolState::none : protocol::ToolState::acting));
    largest_error_um = std::max(largest_error_um, b.error_um());
  }
  INFO("step ", largest_step_um, " um, error ", largest_error_um, " um, of a change without compensation ", without_um);
  // an axis that follows its own compensation finds another value of the map there
  CHECK(largest_step_um <= 1.05 * b.parameters.tool_rate_um_per_s * b.unit.period_s());
  CHECK(without_um > 5.0);
  CHECK(largest_error_um < 0.1);
  CHECK(b.unit.mode() == UnitMode::compensating);
  CHECK(b.unit.fault() == Fault::none);
}

TEST_CASE("a part program changes the tool, and one that the magazine lacks is refused before anything moves") {
  ToolBench b;
  b.begin();
  const auto run = [&](const char* text) {
    const Program program = must(parse_program(text, "tools.nc"));
    return run_program(b.simulation, program, {});
  };
  REQUIRE(run("T30\nG00 X-300 Y-100 Z-50\nM06\nG04 H2\nM02\n").has_value());
  CHECK(b.simulation.tool() == 30);
  CHECK(b.unit.control_lines().tool == 30);
  CHECK(b.error_um() < 0.1);
  const Vector3 before_mm = b.simulation.machine().command_mm();
  CHECK(contains(to_text(must_fail(run("G00 X-10\nT4 M06\n"))), "tools.nc:2: M06: the magazine has no tool 4"));
  CHECK(contains(to_text(must_fail(run("M06\n"))), "expected a tool T before or here"));
  CHECK(b.simulation.machine().command_mm() == before_mm);
}

TEST_CASE("an unknown tool is reported and the last one kept, and beyond the limit the unit isolates") {
  ToolBench b;
  b.parameters.unknown_input_limit_um = 1000.0;
  b.begin();
  REQUIRE(b.simulation.move_to({-140.0, -210.0, -140.0}, 0.0));
  b.simulation.change_tool(2);
  REQUIRE(b.simulation.dwell(2.0));
  REQUIRE(b.unit.fault() == Fault::none);
  const Vector3 before_um = b.compensation_um();
  b.simulation.change_tool(1);
  REQUIRE(b.simulation.dwell(2.0));
  b.simulation.change_tool(2);
  REQUIRE(b.simulation.dwell(2.0));
  b.unit.control({7, true});
  CHECK(b.largest_step_um(3000) < 1e-9);
  CHECK(b.unit.fault() == Fault::live_input);
  CHECK(b.unit.status().fault_address == kToolInput + 1);
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::unknown);
  for (std::size_t a = 0; a < kAxes; ++a) CHECK(b.compensation_um()[a] == Approx(before_um[a]));
  CHECK(all_relays(b, true));

  ToolBench strict;
  strict.parameters.unknown_input_limit_um = 2.0;
  strict.begin();
  REQUIRE(strict.simulation.move_to({-140.0, -210.0, -140.0}, 0.0));
  strict.unit.control({7, true});
  strict.simulation.tick();
  CHECK(strict.unit.fault() == Fault::unknown_input);
  CHECK(strict.unit.mode() == UnitMode::integration);
  CHECK(all_relays(strict, false));
}

TEST_CASE("an unknown load isolates the unit where its rows could be off by more than the limit") {
  for (const double limit_um : {3.0, 6.0}) {
    ToolBench b(false);
    b.parameters.load_range_kg = 500.0;
    b.parameters.unknown_input_limit_um = limit_um;
    b.thermal = {{Component::EYY, ThermalLaw::shift, kLoadInput, kNoInput, 0.01, 0.0, 0.0, 0.0}};
    const auto committed = b.stage_and_commit(b.image(compensation_of));
    REQUIRE_MESSAGE(committed.state == CommandState::done, committed.text);
    REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
    b.reference_all();
    CHECK(b.unit.mode() == (limit_um < 5.0 ? UnitMode::integration : UnitMode::compensating));
    CHECK(b.unit.fault() == (limit_um < 5.0 ? Fault::unknown_input : Fault::live_input));
  }
}

TEST_CASE("a host fills the table and selects a tool in every mode, and a wrong request is refused with its reason") {
  ToolBench b(false);
  CHECK(contains(put_into_table(b, 5, {0.0, 0.0, -100.0}).text, "beyond compensation.tool_range_mm"));
  b.begin();
  CHECK(b.unit.control_lines().tools == 3);
  CHECK(contains(select_tool(b, 5).text, "tool 5 is not in the table"));
  CHECK(contains(put_into_table(b, 0, {}).text, "expected a tool number from 1 to 9999"));
  CHECK(select_tool(b, 2).state == CommandState::done);
  CHECK(contains(b.tell(Command{.code = CommandCode::remove_tool, .tool = 2}).text, "this tool is selected"));
  CHECK(b.tell(Command{.code = CommandCode::remove_tool, .tool = 30}).state == CommandState::done);
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::changing);
  REQUIRE(b.simulation.dwell(2.0));
  CHECK(b.unit.control_lines().tool_offset_mm == Vector3{0.0, 0.0, -250.0});
  // the acting tool is measured again: the output follows
  CHECK(put_into_table(b, 2, {0.0, 0.0, -251.0}).state == CommandState::done);
  CHECK(b.largest_step_um(1000) <= 1.05 * b.parameters.tool_rate_um_per_s * b.unit.period_s());
  CHECK(b.unit.control_lines().tool_offset_mm == Vector3{0.0, 0.0, -251.0});
  ToolBench wired;
  wired.begin();
  CHECK(contains(select_tool(wired, 2).text, "the control selects the tool by its wires"));
}

TEST_CASE("the unit takes away what an instrument on the machine shows, and lets go where it gives no signal") {
  Bench b("[[contribution]]\ncomponent = \"EZX\"\nformula = \"9 + 0.001*p\"\n",
          ideal_machine() + "[emulator]\ndeviation = \"Z\"\n");
  b.thermal = {{Component::EZX, ThermalLaw::active, kDeviationSource, kNoInput, 1.0, 30.0, 20.0, 0.0}};
  b.thermal_settings.hold_s = 10.0;
  b.compensate();
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 0.0));
  const double uncompensated_um = 9.0 - 0.001 * 300.0;
  REQUIRE(b.simulation.run_for(200.0));
  CHECK(std::abs(b.simulation.tool_now(false).error_um[2]) < 0.05 * uncompensated_um);
  CHECK(b.unit.control_lines().deviation.state == InputState::good);
  CHECK(b.unit.fault() == Fault::none);
  b.simulation.lose_deviation(true);
  REQUIRE(b.simulation.run_for(60.0));
  CHECK(b.unit.fault() == Fault::live_input);
  CHECK(b.unit.status().fault_address == kDeviationInput + 1);
  CHECK(b.simulation.tool_now(false).error_um[2] == Approx(uncompensated_um).epsilon(0.01));
  CHECK(b.unit.mode() == UnitMode::compensating);
}

TEST_CASE("a longer tool under a tilted head that bends is compensated without a step") {
  Bench b("", ideal_machine("XYTZCB") +
                  "[axis.B]\ntravel_deg = [-100.0, 100.0]\npivot_mm = [0.0, 0.0, 200.0]\n"
                  "resolution_deg = 0.001\n[axis.C]\ntravel_deg = [-180.0, 180.0]\n"
                  "pivot_mm = [0.0, 0.0, 200.0]\nresolution_deg = 0.001\n");
  RotarySetup setup{{'X', 'Y', 'T', 'Z', 'C', 'B'}, {}, {}, {{}, {100.0}}};
  setup.axes[0] = {'C', 0.001, 0.005, {0.0, 0.0, 1.0}, {0.0, 0.0, 200.0}};
  setup.axes[1] = {'B', 0.001, 0.005, {0.0, 1.0, 0.0}, {0.0, 0.0, 200.0}};
  b.rotary = &setup;
  b.parameters.tool_range_mm = {100.0, 100.0, 300.0};
  b.compensate();
  REQUIRE(put_into_table(b, 1, {0.0, 0.0, -80.0}).state == CommandState::done);
  REQUIRE(put_into_table(b, 2, {0.0, 0.0, -250.0}).state == CommandState::done);
  REQUIRE(select_tool(b, 1).state == CommandState::done);
  b.simulation.machine().turn_to({0.0, 90.0, 90.0});
  REQUIRE(b.simulation.move_to(b.simulation.machine().command_mm(), 0.0));
  REQUIRE(b.simulation.dwell(2.0));
  const auto compensation_um = [&] { return b.unit.monitor().axes[1].compensation_um; };
  CHECK(compensation_um() == Approx(-8.0).epsilon(1e-4));  // along X of the head, which C has turned to Y
  REQUIRE(select_tool(b, 2).state == CommandState::done);
  double largest_um = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double before_um = compensation_um();
    b.simulation.tick();
    largest_um = std::max(largest_um, std::abs(compensation_um() - before_um));
  }
  CHECK(largest_um <= 1.05 * b.parameters.tool_rate_um_per_s * b.unit.period_s());
  CHECK(compensation_um() == Approx(-25.0).epsilon(1e-4));
  CHECK(b.unit.fault() == Fault::none);
}

TEST_CASE("squareness is tried while the unit compensates, without a step, and is forgotten with the mode") {
  ToolBench b;
  const auto tried = [&](double C0Y) {
    return b.tell(Command{.code = CommandCode::try_squareness, .squareness_um_per_m = {C0Y, 0.0, 0.0}});
  };
  CHECK(contains(tried(40.0).text, "the unit does not compensate"));
  b.begin();
  REQUIRE(b.simulation.move_to({-60.0, -210.0, -140.0}, 0.0));
  REQUIRE(b.simulation.dwell(1.0));
  const double before_um = b.compensation_um()[0];
  CHECK(contains(tried(10'001.0).text, "expected squareness values within"));
  REQUIRE(tried(40.0).state == CommandState::done);
  b.simulation.switch_control(false);
  b.simulation.tick();
  b.simulation.switch_control(true);
  b.reference_all();
  CHECK(b.unit.control_lines().squareness_um_per_m == Vector3{});
  REQUIRE(b.simulation.move_to({-60.0, -210.0, -140.0}, 0.0));
  REQUIRE(tried(40.0).state == CommandState::done);
  CHECK(b.largest_step_um(3000) <= 1.05 * b.parameters.tool_rate_um_per_s * b.unit.period_s());
  CHECK(b.compensation_um()[0] - before_um == Approx(0.040 * -210.0).epsilon(0.01));  // of an error of -C0Y y
  CHECK(b.unit.control_lines().squareness_um_per_m == Vector3{40.0, 0.0, 0.0});
  REQUIRE(b.tell(CommandCode::enter_integration).state == CommandState::done);
  CHECK(b.unit.control_lines().squareness_um_per_m == Vector3{});
  REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
  b.reference_all();
  REQUIRE(b.simulation.move_to({-60.0, -210.0, -140.0}, 0.0));
  CHECK(b.compensation_um()[0] == Approx(before_um).epsilon(0.01));
}

TEST_CASE("an active row takes a deviation away no faster than the rate, and does not go beyond it") {
  Bench b("[[contribution]]\ncomponent = \"EZX\"\nformula = \"9 + 0.001*p\"\n",
          ideal_machine() + "[emulator]\ndeviation = \"Z\"\n");
  b.thermal = {{Component::EZX, ThermalLaw::active, kDeviationSource, kNoInput, 1.0, 30.0, 5.0, 0.0}};
  b.compensate();
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 6000.0));
  double least_um = 1e9;
  for (int second = 0; second < 90; ++second) {
    REQUIRE(b.simulation.run_for(1.0));
    least_um = std::min(least_um, b.simulation.tool_now(false).error_um[2]);
  }
  CHECK(std::abs(b.simulation.tool_now(false).error_um[2]) < 0.1);
  CHECK(least_um > -0.2);
  // its axis moves at rapid feed: the instrument is no judge of an axis that follows its command late
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -450.0}, 10'000.0));
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 10'000.0));
  CHECK(b.unit.fault() == Fault::none);
  CHECK(std::abs(b.simulation.tool_now(false).error_um[2]) < 1.0);
}

TEST_CASE("a table of tools that is damaged in both its places leaves the tool unknown until somebody states it") {
  ToolBench b(false);
  b.begin();
  REQUIRE(select_tool(b, 0).state == CommandState::done);
  b.unit.power(false);
  for (std::uint32_t slot = 0; slot < 2; ++slot)
    b.unit.memory().corrupt(kToolRecord.first + slot * kToolTableBytes + 40, 0x11);
  b.unit.power(true);
  REQUIRE(b.simulation.run_for(0.2));
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::unknown);
  REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
  b.reference_all();
  CHECK((b.unit.fault() == Fault::live_input || b.unit.fault() == Fault::unknown_input));
  REQUIRE(b.tell(CommandCode::enter_integration).state == CommandState::done);
  REQUIRE(put_into_table(b, 1, {0.0, 0.0, -80.0}).state == CommandState::done);
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::none);
}

TEST_CASE("a whole table of tools replaces the one before in one piece, while the unit compensates") {
  ToolBench b(false);
  b.begin();
  REQUIRE(select_tool(b, 2).state == CommandState::done);
  REQUIRE(b.simulation.dwell(2.0));
  std::vector<Tool> tools{{2, {0.0, 0.0, -251.0}}};
  for (std::uint16_t number = 100; tools.size() < kMostTools; ++number) tools.push_back({number, {0.0, 0.0, -90.0}});
  CHECK(b.tell(CommandCode::commit_tools).error == UnitError::no_staging);
  CHECK(replace_table(b, tools, 1).error == UnitError::check_mismatch);
  CHECK(contains(replace_table(b, {{5, {0.0, 0.0, -301.0}}}).text, "tool 5 is beyond compensation.tool_range_mm"));
  CHECK(contains(replace_table(b, {{5, {0.0, 0.0, -30.0}}}).text, "tool 2 is selected, and not in the table"));
  CHECK(b.unit.control_lines().tools == 3);
  REQUIRE(replace_table(b, tools).state == CommandState::done);
  CHECK(b.unit.control_lines().tools == kMostTools);
  CHECK(b.largest_step_um(1000) <= 1.05 * b.parameters.tool_rate_um_per_s * b.unit.period_s());
  CHECK(b.unit.control_lines().tool_offset_mm == Vector3{0.0, 0.0, -251.0});
  CHECK(b.unit.mode() == UnitMode::compensating);
}

TEST_CASE("power that fails at any byte of a new table leaves the old one or the new one, never a mixture") {
  const std::vector<Tool> new_tools{{7, {0.0, 0.0, -70.0}}, {8, {0.0, 0.0, -80.0}}};
  std::size_t old_tables = 0, new_tables = 0;
  for (std::uint64_t cut = 0; cut <= kToolTableBytes + 1; cut += cut < 60 || cut + 97 > kToolTableBytes - 60 ? 1 : 97) {
    ToolBench b(false);
    REQUIRE(b.stage_and_commit(b.image(compensation_of)).state == CommandState::done);
    REQUIRE(put_into_table(b, 1, {0.0, 0.0, -80.0}).state == CommandState::done);
    REQUIRE(put_into_table(b, 2, {0.0, 0.0, -250.0}).state == CommandState::done);
    b.unit.memory().power_fails_after(cut);
    (void)replace_table(b, new_tools);
    b.unit.power(false);
    b.unit.power(true);
    const ByteView record = b.unit.memory().view(kToolRecord.first, kToolRecord.size);
    const ToolTable table = must(stored_tools(record));
    const bool is_new = tool_of(table, 7) != nullptr;
    (is_new ? new_tables : old_tables) += 1;
    CHECK((tool_of(table, 8) != nullptr) == is_new);
    CHECK((tool_of(table, 1) == nullptr) == is_new);
    CHECK((tool_of(table, 2) == nullptr) == is_new);
    // what was cut in the middle is told
    const bool is_damaged = protocol::damaged_tool_slots(record) > 0;
    CHECK((b.unit.fault() == Fault::live_input) == is_damaged);
  }
  CHECK(old_tables > 10);
  CHECK(new_tables > 0);
}

TEST_CASE("one damaged copy of the table of tools raises a fault, and the tool is unknown until a host states it") {
  ToolBench b(false);
  b.begin();
  REQUIRE(select_tool(b, 2).state == CommandState::done);
  b.unit.power(false);
  const ByteView record = b.unit.memory().view(kToolRecord.first, kToolRecord.size);
  const std::uint32_t older = next_tool_slot(record), newer = 1 - older;
  b.unit.memory().corrupt(kToolRecord.first + newer * kToolTableBytes + 40, 0x11);
  b.unit.power(true);
  REQUIRE(b.simulation.run_for(0.2));
  CHECK(b.unit.fault() == Fault::live_input);
  CHECK(b.unit.status().fault_address == kToolInput + 1);
  CHECK(b.unit.control_lines().tools == 3);
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::unknown);
  // stated: the table is whole again, and the fault is gone
  REQUIRE(select_tool(b, 30).state == CommandState::done);
  CHECK(b.unit.fault() == Fault::none);
  CHECK(protocol::damaged_tool_slots(b.unit.memory().view(kToolRecord.first, kToolRecord.size)) == 0);
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::acting);
}

TEST_CASE("without the control's power on the relays open, and every axis has to be referenced again") {
  ToolBench b;
  b.begin();
  b.simulation.switch_control(false);
  b.simulation.tick();
  CHECK(all_relays(b, false));
  CHECK(b.unit.mode() == UnitMode::datuming);
  CHECK_FALSE(b.unit.control_lines().control_on);
  REQUIRE(b.simulation.run_for(1.0));
  CHECK(b.unit.mode() == UnitMode::datuming);
  b.simulation.switch_control(true);
  for (const auto& axis : b.unit.status().axes) CHECK_FALSE(axis.referenced);
  b.reference_all();
  CHECK(b.unit.mode() == UnitMode::compensating);
}

TEST_CASE("the table of tools and the selected one survive without power, also in the file of the battery") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "battery.bin";
  ToolBench b(false);
  b.begin();
  REQUIRE(select_tool(b, 30).state == CommandState::done);
  REQUIRE(keep(b.unit.memory(), file).has_value());
  UnitMemory other(1);
  REQUIRE(restore(other, file).has_value());
  const auto table = stored_tools(other.view(kToolRecord.first, kToolRecord.size));
  REQUIRE(table.has_value());
  CHECK(table->selected == 30);
  CHECK(tool_of(*table, 1)->offset_mm == Vector3{0.0, 0.0, -80.0});
  b.unit.power(false);
  b.unit.power(true);
  REQUIRE(b.simulation.run_for(0.2));
  REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
  b.reference_all();
  CHECK(b.unit.control_lines().tool_state == protocol::ToolState::acting);
  CHECK(b.unit.control_lines().tool_offset_mm == Vector3{60.0, -20.0, -180.0});
}
