// A unit at its machine, as the tests of the unit set it up.
#pragma once

#include "base/file.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "tests/ecs_emulator/support/maps.hpp"
#include "tests/support/workshop_machines.hpp"

namespace ecs::emulator::test {

using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;
using protocol::UnitError;

/// Machine, unit and what a host would tell it.
struct Bench {
  explicit Bench(const std::string& errors = "", const std::string& machine = small_machine(),
                 LinkSense link = LinkSense::integrate)
      : simulation(simulation_of(errors, machine)),
        unit({"TEST-1", 1, modules_of(simulation.machine()), link, simulation.description().machine.inputs}),
        parameters(params::default_parameters_for(simulation.description().machine)) {
    simulation.attach(&unit);
    unit.power(true);
    simulation.tick();
  }

  static AxisModules modules_of(const MachineTool& machine) {
    AxisModules modules{};
    for (const Axis a : kAllAxes)
      if (machine.has(a)) modules[index_of(a)] = machine.axis(a).facts().transducer;
    return modules;
  }

  CommandResult tell(Command command) {
    CommandResult result = unit.begin(command);
    for (int i = 0; i < 100 && result.state == CommandState::busy; ++i) {
      simulation.tick();
      result = unit.progress();
    }
    return result;
  }
  CommandResult tell(CommandCode code) { return tell(Command{.code = code}); }

  CommandResult stage_and_commit(const std::vector<std::uint8_t>& image) {
    const auto staged = tell(CommandCode::begin_staging);
    if (staged.state != CommandState::done) return staged;
    CHECK(unit.write_memory(staged.value, image) == UnitError::none);
    return tell(Command{.code = CommandCode::commit_staged,
                        .length = static_cast<std::uint32_t>(image.size()),
                        .digest = protocol::short_digest(protocol::digest_of(image))});
  }

  std::vector<std::uint8_t> image(const CurveFunction& compensation) {
    return image_of(parameters, simulation.description().machine, compensation, unit.settings().serial_number, thermal,
                    thermal_settings, rotary);
  }

  /// Of one value everywhere.
  std::vector<std::uint8_t> flat_image(double value) {
    return image([value](Component, double, Approach) { return value; });
  }

  /// Map in, compensation mode, machine referenced.
  void compensate(const CurveFunction& compensation = [](Component, double, Approach) { return 0.0; }) {
    const auto committed = stage_and_commit(image(compensation));
    REQUIRE_MESSAGE(committed.state == CommandState::done, committed.text);
    REQUIRE(tell(CommandCode::enter_compensation).state == CommandState::done);
    reference_all();
    REQUIRE(unit.mode() == UnitMode::compensating);
  }

  void reference_all() {
    std::vector<Axis> axes;
    for (const Axis a : kAllAxes)
      if (simulation.machine().has(a)) axes.push_back(a);
    REQUIRE(reference(simulation, axes).has_value());
  }

  Simulation simulation;
  Unit unit;
  UnitParameters parameters;
  std::vector<ThermalRow> thermal;  ///< of the maps that image() makes
  ThermalSettings thermal_settings;
  const RotarySetup* rotary = nullptr;  ///< of those maps
};

inline bool all_relays(const Bench& bench, bool closed) {
  for (const auto& drive : bench.simulation.drives())
    if (drive.relay_closed != closed) return false;
  return true;
}

}  // namespace ecs::emulator::test
