// User programs in the unit whose code goes wrong.
#include "tests/ecs_emulator/support/user_program.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;
using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;
using protocol::UnitError;

namespace {

CommandResult run_code(const Code& code) {
  Bench bench;
  put(bench, kUserPrograms, code);
  return run_program(bench);
}

}  // namespace

TEST_CASE("a program cannot write into the bank of the active map, it can into the other one") {
  Bench bench;
  REQUIRE(bench.stage_and_commit(bench.image([](Component, double, Approach) { return 1.0; })).state ==
          CommandState::done);  // bank A
  const auto run_in = [&](const Code& code) {
    put(bench, kUserPrograms, code);
    return run_program(bench, 0);
  };
  const auto active = run_in({0x23, 0xC0, 0x00, 0x10, 0x02, 0x00, 0x4E, 0x75});
  CHECK(active.state == CommandState::failed);
  CHECK(active.text.find("write to 0x100200") != std::string::npos);
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
    CHECK_MESSAGE(result.text.find(one.reason) != std::string::npos, result.text);
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

TEST_CASE("programs start at an even address of system RAM above the registers") {
  Bench bench;
  for (const Address start : {kUserRegisters, kUserPrograms + 1, kEprom.first, kBankA.first, Address{0x300000}})
    CHECK(bench.tell(Command{.code = CommandCode::run_user_software, .address = start}).error ==
          UnitError::bad_argument);
}
