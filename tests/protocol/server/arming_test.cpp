// Who may write to a unit, and what the unit keeps of what was done to it.
#include "protocol/registers/unit_registers.hpp"
#include "protocol/server/host_sessions.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

const std::string kShownCode = "271828";

struct GuardedUnit {
  UnitModel model;
  RegisterServer server{model, kShownCode};
};
struct GuardedHost : GuardedUnit {
  RegisterHost host{server};
};

Command arming(const RegisterHost& host, std::string_view code, std::uint16_t minutes = 30) {
  Command command{.code = CommandCode::arm};
  command.minutes = minutes;
  command.proof = arm_proof(code, host.session());
  return command;
}

std::vector<HostEvent> events_of(RegisterServer& server, std::uint32_t first = 1) {
  (void)server.write(kEventSelect.first, registers_of(EventSelect{first}, 0));
  const auto page = value_in<EventPage>(server.read(kEvents.first, kEvents.count).value()).value();
  std::vector<HostEvent> events;
  for (const HostEvent& event : page.events)
    if (event.number != 0) events.push_back(event);
  return events;
}

/// The error with which a window is opened.
UnitError opened(RegisterServer& server, const WindowOpen& window) {
  REQUIRE(server.write(kWindowOpen.first, registers_of(window, 0)).has_value());
  return value_in<WindowAck>(server.read(kWindowAck.first, kWindowAck.count).value()).value().error;
}

}  // namespace

TEST_CASE_FIXTURE(GuardedHost,
                  "what writes, moves, closes a relay or runs code needs an armed host, what stops does not") {
  const auto last = static_cast<std::uint16_t>(CommandCode::stop);
  for (std::uint16_t number = 1; number <= last; ++number) {
    const auto code = static_cast<CommandCode>(number);
    CAPTURE(name_of(code));
    const bool is_free = switches_off(code) || code == CommandCode::abandon_staged || code == CommandCode::check_memory;
    CHECK((host.give({.code = code, .address = kBankA.first, .length = 10}).error == UnitError::not_armed) != is_free);
  }
  CHECK(host.give(arming(host, kShownCode)).value == 1800);
  CHECK(host.look().armed_s == 1800);
  CHECK(host.give({.code = CommandCode::begin_staging}).state == CommandState::done);
}

TEST_CASE_FIXTURE(GuardedHost, "memory takes no window, and no block of an open one, from a host that is not armed") {
  (void)host.give(arming(host, kShownCode, 1));
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  WindowOpen window{5, kBankA.first, 4, token, false, host.session()};
  CHECK(opened(server, window) == UnitError::none);
  model.unit_clock.ms += 60'000;
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4};
  const Registers block{window.tag, 0, block_check(window, 0, bytes), 0x0102, 0x0304};
  CHECK(server.write(kBlockWrite.first, block).error() == ModbusException::illegal_value);
  CHECK(opened(server, window) == UnitError::not_armed);
  CHECK(model.bank_a[0] == 0);
}

TEST_CASE_FIXTURE(GuardedHost, "a block that comes first after a start of the unit is of no armed host") {
  (void)host.give(arming(host, kShownCode, 1));
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const WindowOpen window{5, kBankA.first, 4, token, false, host.session()};
  CHECK(opened(server, window) == UnitError::none);
  ++model.unit_clock.starts;
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4};
  const Registers block{window.tag, 0, block_check(window, 0, bytes), 0x0102, 0x0304};
  CHECK(server.write(kBlockWrite.first, block).error() == ModbusException::illegal_value);
  CHECK(model.bank_a[0] == 0);
}

TEST_CASE_FIXTURE(GuardedHost, "what names a session is read once, by the host that asked, and is never read back") {
  CHECK(host.session() != 0);
  (void)host.give({.code = CommandCode::output_off});
  CHECK(value_in<SessionState>(server.read(kSession.first, kSession.count).value()).value().session == 0);
  CHECK(value_in<CommandResult>(server.read(kCommandResult.first, kCommandResult.count).value()).value().session == 0);
  for (const Block& block : {kWindowOpen, kCommand, kResultSelect, kSessionOpen}) {
    const Registers read_back = server.read(block.first, block.count).value();
    CHECK(std::all_of(read_back.begin() + 1, read_back.end(), [](std::uint16_t word) { return word == 0; }));
  }
}

TEST_CASE_FIXTURE(GuardedUnit, "a window of a host that is not armed leaves that of an armed one open") {
  RegisterHost armed(server, 1), stranger(server, 2);
  (void)armed.give(arming(armed, kShownCode));
  const WindowOpen window{5,     kBankA.first,   4, armed.give({.code = CommandCode::begin_staging}).token,
                          false, armed.session()};
  CHECK(opened(server, window) == UnitError::none);
  WindowOpen other = window;
  other.tag = 6;
  other.session = stranger.session();
  CHECK(opened(server, other) == UnitError::not_armed);
  other.session = 12345;
  CHECK(opened(server, other) == UnitError::session_unknown);
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4};
  other.session = stranger.session();
  other.tag = window.tag;
  const Registers forged{window.tag, 0, block_check(other, 0, bytes), 0x0102, 0x0304};
  CHECK(server.write(kBlockWrite.first, forged).error() == ModbusException::illegal_value);
  const Registers block{window.tag, 0, block_check(window, 0, bytes), 0x0102, 0x0304};
  CHECK(server.write(kBlockWrite.first, block).has_value());
  CHECK(opened(server, window) == UnitError::none);
  CHECK(model.bank_a[3] == 4);
}

TEST_CASE_FIXTURE(GuardedUnit,
                  "a host is armed with all its programs, for its minutes; another host and another start are not") {
  RegisterHost host(server, 1);
  RegisterHost other(server, 2);
  (void)host.give(arming(host, kShownCode, 2));
  CHECK(other.look().armed_s == 0);
  RegisterHost same(server, 1, 77);
  CHECK(same.session() != host.session());
  CHECK(same.look().armed_s == 120);
  model.unit_clock.ms += 119'999;
  CHECK(host.look().armed_s == 1);
  model.unit_clock.ms += 1;
  CHECK(host.look().armed_s == 0);
  (void)host.give(arming(host, kShownCode, 2));
  CHECK(host.give(arming(host, "", 0)).state == CommandState::done);
  CHECK(host.look().armed_s == 0);
  (void)host.give(arming(host, kShownCode, 2));
  ++model.unit_clock.starts;
  CHECK(host.look().armed_s == 0);
}

TEST_CASE_FIXTURE(
    GuardedHost, "after a wrong code no code is looked at for a while, twice as long with each one, at most a minute") {
  for (const unsigned wait : {1U, 2U, 4U, 8U, 16U, 32U, 60U, 60U}) {
    CHECK(host.give(arming(host, "314159")).error == UnitError::wrong_code);
    CHECK(host.look().wait_s == wait);
    CHECK(host.give(arming(host, kShownCode)).error == UnitError::too_many_codes);
    CHECK(host.look().armed_s == 0);
    model.unit_clock.ms += std::uint64_t{1000} * wait;
  }
  CHECK(host.give(arming(host, kShownCode)).state == CommandState::done);
}

TEST_CASE_FIXTURE(GuardedUnit, "the proof of one session arms no other") {
  RegisterHost host(server, 1);
  RegisterHost thief(server, 2);
  CHECK(thief.give(arming(host, kShownCode)).error == UnitError::wrong_code);
}

TEST_CASE("the unit keeps what hosts did and tried, with host, time and result") {
  UnitModel model;
  model.unit_clock.ms = 61'500;
  RegisterServer server(model, kShownCode);
  RegisterHost host(server, 7);
  Command output{.code = CommandCode::output_compensation};
  output.output_um = 5.0;
  output.relay_on = true;
  (void)host.give(output);
  (void)host.give(arming(host, kShownCode));
  (void)host.give(output);
  (void)host.give(output);
  (void)host.give({.code = CommandCode::check_memory, .address = kBankA.first, .length = 10});
  (void)host.give({.code = CommandCode::output_off});
  const auto events = events_of(server);
  REQUIRE(events.size() == 3);
  CHECK(events[0].host == "host 7");
  CHECK(events[0].unit_time_s == 61);
  CHECK(events[0].text == "X 5 um, relay closed");
  CHECK(events[0].error == UnitError::not_armed);
  CHECK(events[1].code == CommandCode::arm);
  CHECK(events[2].state == CommandState::done);
  CHECK(events[2].times == 2);
  CHECK(events_of(server, 4).front().code == CommandCode::output_off);
}

TEST_CASE("a command that takes time ends in the list of events as it ended, and the oldest of 64 give way") {
  UnitModel model;
  model.busy_polls_left = 100;
  RegisterServer server(model);
  RegisterHost host(server);
  (void)host.give({.code = CommandCode::test_datum});
  (void)host.give({.code = CommandCode::stop});
  CHECK(events_of(server)[0].state == CommandState::failed);
  CHECK(events_of(server)[0].error == UnitError::stopped);
  for (int k = 0; k < 100; ++k) {
    Command position{.code = CommandCode::set_axis_position};
    position.position_mm = k;
    (void)host.give(position);
  }
  CHECK(events_of(server)[0].number == 102 - 64 + 1);
}

TEST_CASE_FIXTURE(GuardedUnit, "an arming that ends on its own and an output that ends without its host are events") {
  RegisterHost silent(server, 7), other(server, 8);
  (void)silent.give(arming(silent, kShownCode, 2));
  (void)other.give(arming(other, kShownCode, 30));
  Command output{.code = CommandCode::output_compensation};
  output.relay_on = true;
  (void)silent.give(output);
  model.unit_clock.ms += 60'000;
  model.outputs_ended_ms = model.unit_clock.ms;
  model.unit_clock.ms += 500'000;
  const auto events = events_of(server, 4);
  REQUIRE(events.size() == 2);
  CHECK(events[0].code == CommandCode::output_compensation);
  CHECK(events[0].text == "relay opened");
  CHECK(events[0].error == UnitError::time_out);
  CHECK(events[0].state == CommandState::failed);
  CHECK(events[0].host == "host 7");
  CHECK(events[0].unit_time_s == 65);
  CHECK(events[1].code == CommandCode::arm);
  CHECK(events[1].text == "has ended");
  CHECK(events[1].error == UnitError::time_out);
  CHECK(events[1].host == "host 7");
  CHECK(events[1].unit_time_s == 125);
  CHECK(events_of(server, 6).empty());  // each is reported once
  (void)other.give(arming(other, "", 0));
  model.unit_clock.ms += 10'000'000;
  CHECK(events_of(server, 7).empty());  // who ends it itself
}

TEST_CASE("a window that is closed for wrong checks is an event of the host that had opened it") {
  UnitModel model;
  RegisterServer server(model);
  RegisterHost host(server, 7);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  CHECK(opened(server, {5, kBankA.first, 480, token, false, host.session()}) == UnitError::none);
  const Registers wrong(kBlockHeaderRegisters + kBlockBytes / 2, 5);
  for (int k = 0; k < 3; ++k) {
    Registers block = wrong;
    block[1] = 0;
    CHECK_FALSE(server.write(kBlockWrite.first, block).has_value());
  }
  const auto events = events_of(server, 2);
  CHECK(only(events).host == "host 7");
  CHECK(events[0].error == UnitError::check_mismatch);
  CHECK(events[0].state == CommandState::refused);
}

TEST_CASE_FIXTURE(GuardedHost, "nobody is armed for more than a day") {
  CHECK(host.give(arming(host, kShownCode, kMostArmed_min + 1)).error == UnitError::bad_argument);
  CHECK(host.give(arming(host, kShownCode, kMostArmed_min)).value == 86'400);
}
