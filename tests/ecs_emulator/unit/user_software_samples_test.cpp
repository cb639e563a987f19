// The user programs of samples/user_software in the unit: 68000 code, assembled here.
#include <cstdlib>
#include <filesystem>

#include "tests/ecs_emulator/support/user_program.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;
using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;
using protocol::UnitError;

namespace {

constexpr const char* kNoAssembler = "m68k-linux-gnu-as is not installed";

bool assembler_installed() { return std::system("command -v m68k-linux-gnu-as >/dev/null") == 0; }

/// Machine code of a sample.
Code assembled(const std::string& name) {
  const auto out = std::filesystem::temp_directory_path() / ("ecs-" + name + ".bin");
  const std::string command = "samples/user_software/assemble samples/user_software/" + name + ".s " + out.string();
  REQUIRE(std::system(command.c_str()) == 0);
  const std::string bytes = read_file(out).value();
  std::filesystem::remove(out);
  return {bytes.begin(), bytes.end()};
}

std::uint32_t long_at(Bench& bench, Address address) {
  return load_big<std::uint32_t>(bench.unit.memory().view(address, 4), 0);
}

Code longs(std::initializer_list<std::uint32_t> values) {
  Code bytes(values.size() * 4);
  std::size_t at = 0;
  for (const std::uint32_t value : values) {
    store_big<std::uint32_t>(bytes, at, value);
    at += 4;
  }
  return bytes;
}

}  // namespace

TEST_CASE("the checksum of a memory range is the sum that the test computes") {
  Bench bench;
  SKIP_UNLESS(assembler_installed(), kNoAssembler);
  const Code program = assembled("checksum");
  put(bench, kUserPrograms, program);
  put(bench, 0x043000, longs({kEprom.first + 0x400, 100}));
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : bench.unit.memory().view(kEprom.first + 0x400, 100)) sum += byte;
  const CommandResult result = run_program(bench, 0x043000);
  CHECK(result.state == CommandState::done);
  CHECK(result.value == sum);
  CHECK(long_at(bench, kUserRegisters) == sum);                                  // D0
  CHECK(long_at(bench, kUserRegisters + 32 + 4) == kEprom.first + 0x400 + 100);  // A1
  CHECK(long_at(bench, kUserRegisters + 32 + 28) ==
        kSystemRam.first + kSystemRam.size);  // A7: the return was taken off
}

TEST_CASE("a RAM test written by the user finds a stuck bit of axis memory and changes nothing") {
  Bench bench;
  SKIP_UNLESS(assembler_installed(), kNoAssembler);
  const Code program = assembled("ram_test");
  put(bench, kUserPrograms, program);
  bench.unit.memory().write(kBankB.first + 0x100, std::array<std::uint8_t, 4>{1, 2, 3, 4});
  CHECK(run_program(bench, kBankB.first).value == 0);
  CHECK(long_at(bench, kBankB.first + 0x100) == 0x01020304);
  bench.unit.memory().stick(kBankB.first + 0x123, 3, 1);
  CHECK(run_program(bench, kBankB.first).value == kBankB.first + 0x123);
}

TEST_CASE("a program follows the axes period by period") {
  Bench bench;
  SKIP_UNLESS(assembler_installed(), kNoAssembler);
  const Code program = assembled("position_logger");
  put(bench, kUserPrograms, program);
  REQUIRE(bench.tell(Command{.code = CommandCode::set_axis_position, .axis = Axis::X, .position_mm = -10.0}).state ==
          CommandState::done);
  REQUIRE(bench.unit.begin(Command{.code = CommandCode::run_user_software, .address = kUserPrograms, .argument = 1000})
              .state == CommandState::busy);
  Vector3 to_mm = bench.simulation.machine().command_mm();
  to_mm[0] += 5.0;
  REQUIRE(bench.simulation.move_to(to_mm, 1200.0));
  CommandResult result = bench.unit.progress();
  for (int i = 0; i < 1000 && result.state == CommandState::busy; ++i) {
    bench.simulation.tick();
    result = bench.unit.progress();
  }
  REQUIRE(result.state == CommandState::done);
  CHECK(result.value == 1000);
  CHECK(static_cast<std::int32_t>(long_at(bench, 0x042004)) == doctest::Approx(-10'000).epsilon(0.01));
  const auto at = [&](std::uint32_t k) { return static_cast<std::int32_t>(long_at(bench, 0x042000 + 16 * k + 4)); };
  for (std::uint32_t k = 1; k < 1000; ++k) {
    CHECK(long_at(bench, 0x042000 + 16 * k) == long_at(bench, 0x042000) + k);  // no period is missed
    CHECK(at(k) >= at(k - 1));
  }
  CHECK(at(999) == doctest::Approx(-5'000).epsilon(0.001));
}
