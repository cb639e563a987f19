// User programs in the unit: those of samples/user_software (68000 code, assembled here), and code that goes wrong.
#include <cstdlib>
#include <filesystem>

#include "core/address_map.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

using Code = std::vector<std::uint8_t>;

void put(Bench& bench, Address address, const Code& code) {
  REQUIRE(bench.unit.write_memory(address, code) == protocol::UnitError::none);
}

protocol::CommandResult run_program(Bench& bench, std::uint32_t argument = 0, int periods = 2000) {
  protocol::CommandResult result = bench.unit.begin(protocol::Command{
      .code = protocol::CommandCode::run_user_software, .address = kUserPrograms, .argument = argument});
  for (int i = 0; i < periods && result.state == protocol::CommandState::busy; ++i) {
    bench.simulation.tick();
    result = bench.unit.progress();
  }
  return result;
}

CommandResult run_code(const Code& code) {
  Bench bench;
  put(bench, kUserPrograms, code);
  return run_program(bench);
}

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

TEST_CASE_FIXTURE(Bench, "a program cannot write into the bank of the active map, it can into the other one") {
  REQUIRE(stage_and_commit(flat_image(1.0)).state == CommandState::done);  // bank A
  const auto run_in = [&](const Code& code) {
    put(*this, kUserPrograms, code);
    return run_program(*this, 0);
  };
  const auto active = run_in({0x23, 0xC0, 0x00, 0x10, 0x02, 0x00, 0x4E, 0x75});
  CHECK(active.state == CommandState::failed);
  CHECK(contains(active.text, "write to 0x100200"));
  CHECK(run_in({0x23, 0xC0, 0x00, 0x20, 0x02, 0x00, 0x4E, 0x75}).state == CommandState::done);
}

TEST_CASE("what a program must not do ends it with the reason and the place") {
  struct Wrong {
    Code code;
    const char* reason;
  };
  const std::vector<Wrong> wrong{
      {{0x20, 0x39, 0x00, 0x30, 0x00, 0x00}, "bus error: read of 0x300000 at PC 0x041000"},
      {{0x23, 0xC0, 0x00, 0x00, 0x10, 0x00}, "bus error: write to 0x001000 at PC 0x041000"},  // EPROM
      {{0x23, 0xC0, 0x00, 0x0F, 0x00, 0x00}, "bus error: write to 0x0F0000 at PC 0x041000"},  // commit records
      {{0x23, 0xC0, 0x00, 0x0E, 0x00, 0x04}, "bus error: write to 0x0E0004 at PC 0x041000"},  // inputs
      {{0x20, 0x39, 0x00, 0x04, 0x20, 0x01}, "address error: odd address 0x042001 at PC 0x041000"},
      {{0x4E, 0xF9, 0x00, 0x30, 0x00, 0x00}, "bus error: jump to 0x300000"},
      {{0x4A, 0xFC}, "illegal instruction at PC 0x041000"},
      {{0x80, 0xFC, 0x00, 0x00}, "division by zero"},
      {{0x4E, 0x43}, "TRAP #3"},
      {{0x4E, 0x72, 0x27, 0x00}, "STOP"}};
  for (const Wrong& one : wrong) {
    const CommandResult result = run_code(one.code);
    CHECK(result.state == CommandState::failed);
    CHECK(result.error == UnitError::unit_fault);
    CHECK_MESSAGE(contains(result.text, one.reason), result.text);
  }
}

TEST_CASE("a program that never ends is stopped by the host or by its limit") {
  const Code for_ever{0x60, 0xFE};
  Bench bench;
  put(bench, kUserPrograms, for_ever);
  CHECK(run_program(bench, 0, 50).state == CommandState::busy);
  CHECK(bench.tell(CommandCode::stop).state == CommandState::done);
  CHECK(bench.unit.progress().error == UnitError::stopped);
  const CommandResult result = run_program(bench, 0, 61'000);
  CHECK(result.state == CommandState::failed);
  CHECK(result.error == UnitError::time_out);
  CHECK(bench.unit.mode() == UnitMode::integration);
}

TEST_CASE_FIXTURE(Bench, "programs start at an even address of system RAM above the registers") {
  for (const Address start : {kUserRegisters, kUserPrograms + 1, kEprom.first, kBankA.first, Address{0x300000}})
    CHECK(tell(Command{.code = CommandCode::run_user_software, .address = start}).error == UnitError::bad_argument);
}

TEST_CASE_FIXTURE(Bench, "the checksum of a memory range is the sum that the test computes") {
  SKIP_UNLESS(assembler_installed(), kNoAssembler);
  const Code program = assembled("checksum");
  put(*this, kUserPrograms, program);
  put(*this, 0x043000, longs({kEprom.first + 0x400, 100}));
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : unit.memory().view(kEprom.first + 0x400, 100)) sum += byte;
  const CommandResult result = run_program(*this, 0x043000);
  CHECK(result.state == CommandState::done);
  CHECK(result.value == sum);
  CHECK(long_at(*this, kUserRegisters) == sum);                                  // D0
  CHECK(long_at(*this, kUserRegisters + 32 + 4) == kEprom.first + 0x400 + 100);  // A1
  CHECK(long_at(*this, kUserRegisters + 32 + 28) ==
        kSystemRam.first + kSystemRam.size);  // A7: the return was taken off
}

TEST_CASE_FIXTURE(Bench, "a RAM test written by the user finds a stuck bit of axis memory and changes nothing") {
  SKIP_UNLESS(assembler_installed(), kNoAssembler);
  const Code program = assembled("ram_test");
  put(*this, kUserPrograms, program);
  unit.memory().write(kBankB.first + 0x100, std::array<std::uint8_t, 4>{1, 2, 3, 4});
  CHECK(run_program(*this, kBankB.first).value == 0);
  CHECK(long_at(*this, kBankB.first + 0x100) == 0x01020304);
  unit.memory().stick(kBankB.first + 0x123, 3, 1);
  CHECK(run_program(*this, kBankB.first).value == kBankB.first + 0x123);
}

TEST_CASE_FIXTURE(Bench, "a program follows the axes period by period") {
  SKIP_UNLESS(assembler_installed(), kNoAssembler);
  const Code program = assembled("position_logger");
  put(*this, kUserPrograms, program);
  REQUIRE(tell(Command{.code = CommandCode::set_axis_position, .axis = Axis::X, .position_mm = -10.0}).state ==
          CommandState::done);
  REQUIRE(
      unit.begin(Command{.code = CommandCode::run_user_software, .address = kUserPrograms, .argument = 1000}).state ==
      CommandState::busy);
  Vector3 to_mm = simulation.machine().command_mm();
  to_mm[0] += 5.0;
  REQUIRE(simulation.move_to(to_mm, 1200.0));
  CommandResult result = unit.progress();
  for (int i = 0; i < 1000 && result.state == CommandState::busy; ++i) {
    simulation.tick();
    result = unit.progress();
  }
  REQUIRE(result.state == CommandState::done);
  CHECK(result.value == 1000);
  CHECK(static_cast<std::int32_t>(long_at(*this, 0x042004)) == Approx(-10'000).epsilon(0.01));
  const auto at = [&](std::uint32_t k) { return static_cast<std::int32_t>(long_at(*this, 0x042000 + 16 * k + 4)); };
  for (std::uint32_t k = 1; k < 1000; ++k) {
    CHECK(long_at(*this, 0x042000 + 16 * k) == long_at(*this, 0x042000) + k);  // no period is missed
    CHECK(at(k) >= at(k - 1));
  }
  CHECK(at(999) == Approx(-5'000).epsilon(0.001));
}
