// Programs of the user in a unit: put into its memory, run.
#pragma once

#include "core/address_map.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

namespace ecs::emulator::test {

using Code = std::vector<std::uint8_t>;

inline void put(Bench& bench, Address address, const Code& code) {
  REQUIRE(bench.unit.write_memory(address, code) == protocol::UnitError::none);
}

inline protocol::CommandResult run_program(Bench& bench, std::uint32_t argument = 0, int periods = 2000) {
  protocol::CommandResult result = bench.unit.begin(protocol::Command{
      .code = protocol::CommandCode::run_user_software, .address = kUserPrograms, .argument = argument});
  for (int i = 0; i < periods && result.state == protocol::CommandState::busy; ++i) {
    bench.simulation.tick();
    result = bench.unit.progress();
  }
  return result;
}

}  // namespace ecs::emulator::test
