// Who may write to a unit, and what the unit keeps of what was done to it.
#include <algorithm>
#include <cstdlib>
#include <limits>

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
  RegisterServer server{model, {kShownCode, true}};
};
struct GuardedHost : GuardedUnit {
  RegisterHost host{server};
};

std::vector<HostEvent> events_of(RegisterServer& server, std::uint32_t first = 1) {
  (void)server.write(kEventSelect.first, registers_of(EventSelect{first}, 0));
  const auto page = value_in<EventPage>(server.read(kEvents.first, kEvents.count).value()).value();
  std::vector<HostEvent> events;
  for (const HostEvent& event : page.events)
    if (event.number != 0) events.push_back(event);
  return events;
}

const std::vector<std::uint8_t> kFourBytes{1, 2, 3, 4};

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
  CHECK(host.arm(kShownCode).armed_s == 1800);
  CHECK(host.look().armed_s == 1800);
  CHECK(host.give({.code = CommandCode::begin_staging}).state == CommandState::done);
}

TEST_CASE_FIXTURE(GuardedHost, "memory takes no window, and no block of an open one, from a host that is not armed") {
  (void)host.arm(kShownCode, 1);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  WindowOpen window{5, kBankA.first, 4, token, false, {host.session(), 1}};
  CHECK(host.open(window).error == UnitError::none);
  model.unit_clock.ms += 60'000;
  const Registers block = block_registers(host.key(), window, 0, kFourBytes);
  CHECK(server.write(kBlockWrite.first, block).error() == ModbusException::illegal_value);
  CHECK(host.open(window).error == UnitError::not_armed);
  CHECK(model.bank_a[0] == 0);
}

TEST_CASE_FIXTURE(GuardedHost, "a block that comes first after a start of the unit is of no armed host") {
  (void)host.arm(kShownCode, 1);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const WindowOpen window{5, kBankA.first, 4, token, false, {host.session(), 1}};
  CHECK(host.open(window).error == UnitError::none);
  ++model.unit_clock.starts;
  const Registers block = block_registers(host.key(), window, 0, kFourBytes);
  CHECK(server.write(kBlockWrite.first, block).error() == ModbusException::illegal_value);
  CHECK(model.bank_a[0] == 0);
}

TEST_CASE_FIXTURE(GuardedHost, "what names a session is read once, by the host that asked, and is never read back") {
  CHECK(host.session() != 0);
  (void)host.give({.code = CommandCode::output_off});
  CHECK(value_in<SessionState>(server.read(kSession.first, kSession.count).value()).value().session == 0);
  CHECK(value_in<CommandResult>(server.read(kCommandResult.first, kCommandResult.count).value()).value().session == 0);
  CHECK_FALSE(server.read(kResultSelect.first, kResultSelect.count).has_value());
  for (const Block& block : {kWindowOpen, kCommand, kSessionOpen}) {
    const Registers read_back = server.read(block.first, block.count).value();
    CHECK(std::all_of(read_back.begin() + 1, read_back.end(), [](std::uint16_t word) { return word == 0; }));
  }
}

TEST_CASE_FIXTURE(GuardedUnit, "a window of a host that is not armed leaves that of an armed one open") {
  RegisterHost armed(server, 1), stranger(server, 2);
  (void)armed.arm(kShownCode);
  const WindowOpen window{5,     kBankA.first,        4, armed.give({.code = CommandCode::begin_staging}).token,
                          false, {armed.session(), 1}};
  CHECK(armed.open(window).error == UnitError::none);
  WindowOpen other = window;
  other.number = 6;
  CHECK(stranger.open(other).error == UnitError::wrong_key);  // in the armed host's session, without its key
  other.asker.session = stranger.session();
  CHECK(stranger.open(other).error == UnitError::not_armed);
  other.asker.session = 12345;
  CHECK(stranger.open(other).error == UnitError::session_unknown);
  CHECK(server.write(kBlockWrite.first, block_registers(armed.key(), window, 0, kFourBytes)).has_value());
  CHECK(armed.open(window).error == UnitError::none);
  CHECK(model.bank_a[3] == 4);
}

TEST_CASE_FIXTURE(GuardedUnit, "a block without the key of its host closes the window and writes nothing") {
  RegisterHost armed(server, 1);
  (void)armed.arm(kShownCode);
  const WindowOpen window{5,     kBankA.first,        4, armed.give({.code = CommandCode::begin_staging}).token,
                          false, {armed.session(), 1}};
  CHECK(armed.open(window).error == UnitError::none);
  CHECK(server.write(kBlockWrite.first, block_registers(std::nullopt, window, 0, kFourBytes)).error() ==
        ModbusException::illegal_value);
  CHECK(armed.open(window).error == UnitError::check_mismatch);
  CHECK(model.bank_a[0] == 0);
}

TEST_CASE_FIXTURE(GuardedHost,
                  "a stranger in the session of a host that is not armed yet uses up none of its numbers") {
  Command last = host.next({.code = CommandCode::abandon_staged});
  last.sequence = std::numeric_limits<std::uint32_t>::max();
  (void)host.send(last);
  CHECK(host.arm(kShownCode).error == UnitError::none);
  CHECK(host.give({.code = CommandCode::begin_staging}).state == CommandState::done);
}

TEST_CASE_FIXTURE(GuardedHost,
                  "a stop of a host without a key is carried out, whatever a stranger gives in its session") {
  const Command off = host.next({.code = CommandCode::output_off});
  Command strangers = off;
  for (const std::uint32_t sequence : {off.sequence, std::numeric_limits<std::uint32_t>::max()}) {
    strangers.code = CommandCode::check_memory;
    strangers.address = kBankA.first;
    strangers.length = 4;
    strangers.sequence = sequence;
    CHECK(host.send(strangers).state == CommandState::done);
    model.log.clear();
    CHECK(host.send(off).state == CommandState::done);
    CHECK(model.log == std::vector{CommandCode::output_off});
  }
}

TEST_CASE_FIXTURE(GuardedUnit, "of blocks with checks by chance none is taken") {
  const char* const wanted = std::getenv("ECS_FORGED_BLOCKS");  // 10000000 take a minute
  const std::uint64_t count = wanted == nullptr ? 50'000 : std::strtoull(wanted, nullptr, 10);
  RegisterHost armed(server, 1);
  (void)armed.arm(kShownCode);
  WindowOpen window{0,     kBankA.first,        4, armed.give({.code = CommandCode::begin_staging}).token,
                    false, {armed.session(), 1}};
  std::uint64_t taken = 0, looked_at = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    ++window.number;
    looked_at += armed.open(window).error == UnitError::none ? 1U : 0U;
    Registers block = block_registers(std::nullopt, window, 0, kFourBytes);
    const std::uint64_t check = chance_64();  // everything else is what its host would send
    for (std::size_t i = 0; i < kKeyedCheckRegisters; ++i) block[2 + i] = static_cast<std::uint16_t>(check >> 16 * i);
    taken += server.write(kBlockWrite.first, block) ? 1U : 0U;
  }
  if (wanted != nullptr) MESSAGE(count << " forged blocks, " << taken << " taken");
  CHECK(looked_at == count);
  CHECK(taken == 0);
  CHECK(model.bank_a[0] == 0);
  ++window.number;
  (void)armed.open(window);
  CHECK(server.write(kBlockWrite.first, block_registers(armed.key(), window, 0, kFourBytes)).has_value());
}

TEST_CASE_FIXTURE(GuardedUnit,
                  "in the session of an armed host only its key gives commands, but everybody may switch off") {
  RegisterHost armed(server, 1);
  (void)armed.arm(kShownCode);
  (void)armed.look();
  const Command begin = armed.next({.code = CommandCode::begin_staging});
  const auto given = [&](const Command& command, const std::optional<Secret>& key) {
    (void)server.write(kCommand.first, sealed(registers_of(command, 0), Keyed::command, key));
    return armed.result();
  };
  CHECK(given(begin, std::nullopt).error == UnitError::wrong_key);
  CHECK(given(begin, Secret{1}).error == UnitError::wrong_key);
  CHECK(model.log.empty());
  CHECK(given(begin, armed.key()).state == CommandState::done);
  Command off = armed.next({.code = CommandCode::output_off});
  off.sequence += 1'000'000;
  CHECK(given(off, std::nullopt).state == CommandState::done);
  CHECK(armed.give({.code = CommandCode::clear_fault}).state == CommandState::done);  // its count goes on
  off.asker.session = 0;
  CHECK(given(off, std::nullopt).state == CommandState::done);  // nobody needs a session for it
  off.code = CommandCode::clear_fault;
  CHECK(given(off, std::nullopt).state != CommandState::done);
}

TEST_CASE_FIXTURE(GuardedUnit,
                  "answers to an armed host carry its check, bound to what it asked, those to others none") {
  RegisterHost armed(server, 1);
  (void)armed.arm(kShownCode);
  (void)armed.look();
  const auto asked = [&](std::uint32_t session, std::uint32_t challenge, std::uint16_t echo) {
    (void)server.write(kEcho.first, registers_of(EchoAsk{{session, challenge}}, echo));
    return server.read(kActiveMap.first, kActiveMap.count).value();
  };
  const Secret key = armed.key().value();
  const Registers answer = asked(armed.session(), 7, 9);
  CHECK(check_at_end(answer) == answer_check(key, kActiveMap, 7, answer));
  CHECK(check_at_end(answer) != answer_check(key, kActiveMap, 8, answer));
  CHECK(check_at_end(answer) != answer_check(key, kSession, 7, answer));
  CHECK(check_at_end(asked(armed.session(), 7, 10)) != check_at_end(answer));
  CHECK(check_at_end(asked(armed.session() + 1, 7, 9)) == 0);
  CHECK(check_at_end(server.read(kActiveMap.first, kActiveMap.count).value()) == 0);  // nobody asked
}

TEST_CASE_FIXTURE(GuardedUnit,
                  "a host is armed with all its programs, for its minutes; another host and another start are not") {
  RegisterHost host(server, 1);
  RegisterHost other(server, 2);
  (void)host.arm(kShownCode, 2);
  CHECK(other.look().armed_s == 0);
  RegisterHost same(server, 1, 77);
  same.share_with(host);
  CHECK(same.session() != host.session());
  CHECK(same.look().armed_s == 120);
  model.unit_clock.ms += 119'999;
  CHECK(host.look().armed_s == 1);
  model.unit_clock.ms += 1;
  CHECK(host.look().armed_s == 0);
  (void)host.arm(kShownCode, 2);
  CHECK(host.give({.code = CommandCode::arm}).state == CommandState::done);
  CHECK(host.look().armed_s == 0);
  (void)host.arm(kShownCode, 2);
  ++model.unit_clock.starts;
  CHECK(host.look().armed_s == 0);
}

TEST_CASE_FIXTURE(
    GuardedHost, "after a wrong code no code is looked at for a while, twice as long with each one, at most a minute") {
  for (const unsigned wait : {1U, 2U, 4U, 8U, 16U, 32U, 60U, 60U}) {
    CHECK(host.arm("314159").error == UnitError::wrong_code);
    CHECK(host.look().wait_s == wait);
    CHECK(host.arm(kShownCode).error == UnitError::too_many_codes);
    CHECK(host.look().armed_s == 0);
    model.unit_clock.ms += std::uint64_t{1000} * wait;
  }
  CHECK(host.arm(kShownCode).error == UnitError::none);
}

TEST_CASE_FIXTURE(GuardedHost,
                  "a guess costs an exchange: the second confirmation of one gets the answer of the first") {
  const ExchangeTerms terms = exchange_terms("314159", model.serial_number, host.session(), 30);
  const HalfExchange own = half_exchange(terms);
  const auto ask = [&](const Block& block, const auto& value) {
    (void)server.write(block.first, registers_of(value, 0));
    return value_in<ArmAnswer>(server.read(kArmAnswer.first, kArmAnswer.count).value()).value();
  };
  const ArmAnswer shared = ask(kArmShare, ArmShare{host.session(), 30, own.share});
  CHECK(shared.confirmation == Confirmation{});  // the unit shows nothing that a guess could be held against
  const auto confirmed = [&](std::string_view code) {
    const ExchangeTerms guess = exchange_terms(code, model.serial_number, host.session(), 30);
    const SharedKey key = shared_key(guess, End::host, own, shared.share).value();
    return ask(kArmConfirm, ArmConfirm{host.session(), confirmation_of(guess, End::host, key, own.share)});
  };
  CHECK(confirmed("314159").error == UnitError::wrong_code);
  CHECK(confirmed(kShownCode).error == UnitError::wrong_code);
  CHECK(host.look().armed_s == 0);
  CHECK(host.look().wait_s == 1);
}

TEST_CASE_FIXTURE(GuardedHost, "a share that is no point, or the neutral element, ends the exchange") {
  Share neutral{}, no_point{};
  no_point.fill(0xFF);
  for (const Share& share : {neutral, no_point}) {
    (void)server.write(kArmShare.first, registers_of(ArmShare{host.session(), 30, share}, 0));
    const auto answer = value_in<ArmAnswer>(server.read(kArmAnswer.first, kArmAnswer.count).value()).value();
    CHECK(answer.error == UnitError::wrong_key);
    CHECK(answer.share == Share{});
  }
  CHECK(host.look().wait_s == 0);
}

TEST_CASE_FIXTURE(GuardedHost,
                  "of exchanges one place gets eight at once and ten a second: they take time of the loop") {
  int answered = 0;
  for (int k = 0; k < 50; ++k) {
    const HalfExchange own = half_exchange(exchange_terms("", model.serial_number, host.session(), 30));
    (void)server.write(kArmShare.first, registers_of(ArmShare{host.session(), 30, own.share}, 0));
    const auto answer = value_in<ArmAnswer>(server.read(kArmAnswer.first, kArmAnswer.count).value()).value();
    answered += answer.error == UnitError::none;
    model.unit_clock.ms += 20;
  }
  CHECK(answered >= 8 + 9);
  CHECK(answered <= 8 + 10);
}

TEST_CASE_FIXTURE(GuardedUnit, "wrong codes from one place delay no other place") {
  server.arrives_on(1, "10.0.0.66");
  RegisterHost stranger(server, 2);
  for (int k = 0; k < 5; ++k) (void)stranger.arm("314159");
  CHECK(stranger.look().wait_s > 0);
  server.arrives_on(2, "10.0.0.5");
  RegisterHost host(server, 1);
  CHECK(host.look().wait_s == 0);
  CHECK(host.arm(kShownCode).error == UnitError::none);
}

TEST_CASE("after a hundred wrong codes a unit shows another one, and with a fixed one it looks at one a minute") {
  for (const bool fixed : {false, true}) {
    CAPTURE(fixed);
    UnitModel model;
    RegisterServer server(model, {kShownCode, fixed});
    for (unsigned k = 0; k < kMostWrongCodes; ++k) {
      server.arrives_on(k, "10.0.0." + std::to_string(k));
      CHECK(RegisterHost(server, 2).arm("wrong").error == UnitError::wrong_code);
    }
    server.arrives_on(1000, "10.0.1.1");
    RegisterHost host(server, 1);
    CHECK(model.shown_code.empty() == fixed);
    if (!fixed) {
      CHECK(model.shown_code != kShownCode);
      CHECK(host.arm(model.shown_code).error == UnitError::none);
      continue;
    }
    CHECK(host.look().wait_s == 60);
    model.unit_clock.ms += 60'000;
    CHECK(host.arm(kShownCode).error == UnitError::none);
  }
}

TEST_CASE_FIXTURE(GuardedUnit, "what strangers do washes away no event of an armed host") {
  RegisterHost armed(server, 7);
  (void)armed.arm(kShownCode);
  (void)armed.give({.code = CommandCode::begin_staging});
  for (std::uint32_t k = 0; k < 200; ++k) {
    RegisterHost stranger(server, 100 + k);
    (void)stranger.give({.code = CommandCode::output_off});
  }
  CHECK(events_of(server)[0].code == CommandCode::arm);
  CHECK(events_of(server)[1].code == CommandCode::begin_staging);
  CHECK(armed.give({.code = CommandCode::clear_fault}).state == CommandState::done);  // its session is there yet
}

TEST_CASE("the unit keeps what hosts did and tried, with host, time and result") {
  UnitModel model;
  model.unit_clock.ms = 61'500;
  RegisterServer server(model, {kShownCode, true});
  RegisterHost host(server, 7);
  Command output{.code = CommandCode::output_compensation};
  output.output_um = 5.0;
  output.relay_on = true;
  (void)host.give(output);
  (void)host.arm(kShownCode);
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

TEST_CASE("an event says on which map a transfer is based and which tool is selected") {
  CHECK(arguments_in_words({.code = CommandCode::begin_staging, .staging_from = StagingFrom::kept}) ==
        "over the inactive map");
  CHECK(arguments_in_words({.code = CommandCode::begin_staging, .staging_from = StagingFrom::active}) ==
        "based on the active map");
  CHECK(arguments_in_words({.code = CommandCode::select_tool, .tool = 7}) == "7");
  CHECK(arguments_in_words({.code = CommandCode::select_tool, .tool = 0}) == "0 (none)");
}

TEST_CASE("a table of tools is one event: what replaces it, not what gathers it; a refusal is one as well") {
  UnitModel model;
  RegisterServer server(model);
  RegisterHost host(server, 7);
  const std::size_t before = events_of(server).size();
  for (const CommandCode code : {CommandCode::begin_tools, CommandCode::stage_tool, CommandCode::stage_tool})
    CHECK(host.give({.code = code, .tool = 3}).state == CommandState::done);
  CHECK(events_of(server).size() == before);
  CHECK(host.give({.code = CommandCode::commit_tools, .length = 2, .digest = 0x1234567800000000}).state ==
        CommandState::done);
  REQUIRE(events_of(server).size() == before + 1);
  CHECK(events_of(server).back().code == CommandCode::commit_tools);
  CHECK(events_of(server).back().text == "2 tools, SHA 123456");
  CHECK(host.give({.code = CommandCode::set_tool, .tool = 3}).state == CommandState::done);
  CHECK(events_of(server).size() == before + 2);
}

TEST_CASE_FIXTURE(GuardedHost, "an event long after its host made itself known has the time of day of the event") {
  model.unit_clock.ms = 5'000;
  SessionOpen open;
  open.key = 7;
  open.unix_time_s = 1'700'000'000;
  (void)server.write(kSessionOpen.first, registers_of(open, 0));
  const auto session = value_in<SessionState>(server.read(kSession.first, kSession.count).value()).value().session;
  for (const std::uint32_t later_s : {0U, 600U}) {
    model.unit_clock.ms = 5'000 + 1000 * later_s;
    Command command;
    command.asker = {session, 1};
    command.sequence = 1 + later_s;
    command.code = CommandCode::begin_staging;
    (void)server.write(kCommand.first, registers_of(command, 0));
    const HostEvent newest = events_of(server).back();
    CHECK(newest.unix_time_s == 1'700'000'000 + later_s);
    CHECK(newest.unit_time_s == 5 + later_s);
  }
}

TEST_CASE("outputs are switched off and the mode is left while a command takes time, which ends as stopped") {
  for (const CommandCode code : {CommandCode::output_off, CommandCode::enter_integration, CommandCode::stop}) {
    UnitModel model;
    model.busy_polls_left = 100;
    RegisterServer server(model);
    RegisterHost armed(server, 7), stranger(server, 8);
    (void)armed.give({.code = CommandCode::test_datum});
    CHECK(armed.give({.code = CommandCode::set_axis_position}).error == UnitError::busy);
    CHECK(stranger.give({.code = code}).state == CommandState::done);
    CHECK(armed.give({.code = CommandCode::set_axis_position}).state == CommandState::done);
    const auto events = events_of(server);
    const auto ended = std::ranges::find(events, CommandCode::test_datum, &HostEvent::code);
    REQUIRE(ended != events.end());
    CHECK(ended->state == CommandState::failed);
    CHECK(ended->error == UnitError::stopped);
  }
}

TEST_CASE("a command that takes time ends in the list of events as it ended, and the oldest of 64 give way") {
  UnitModel model;
  model.busy_polls_left = 100;
  RegisterServer server(model);
  RegisterHost host(server);
  (void)host.give({.code = CommandCode::test_datum});
  (void)host.give({.code = CommandCode::stop});
  CHECK(events_of(server)[1].state == CommandState::failed);  // behind that of arming
  CHECK(events_of(server)[1].error == UnitError::stopped);
  for (int k = 0; k < 100; ++k) {
    Command position{.code = CommandCode::set_axis_position};
    position.position_mm = k;
    (void)host.give(position);
  }
  CHECK(events_of(server)[0].number == 103 - 64 + 1);
}

TEST_CASE_FIXTURE(GuardedUnit, "an arming that ends on its own and an output that ends without its host are events") {
  RegisterHost silent(server, 7), other(server, 8);
  (void)silent.arm(kShownCode, 2);
  (void)other.arm(kShownCode, 30);
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
  (void)other.give({.code = CommandCode::arm});
  model.unit_clock.ms += 10'000'000;
  CHECK(events_of(server, 7).empty());  // who ends it itself
}

TEST_CASE("a window that is closed for a wrong check is an event of the host that had opened it") {
  UnitModel model;
  RegisterServer server(model);
  RegisterHost host(server, 7);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const WindowOpen window{5, kBankA.first, 480, token, false, {host.session(), 1}};
  CHECK(host.open(window).error == UnitError::none);
  const std::vector<std::uint8_t> bytes(kBlockBytes);
  CHECK_FALSE(server.write(kBlockWrite.first, block_registers(std::nullopt, window, 0, bytes)).has_value());
  const auto events = events_of(server, 3);
  CHECK(only(events).host == "host 7");
  CHECK(events[0].error == UnitError::check_mismatch);
  CHECK(events[0].state == CommandState::refused);
}

TEST_CASE_FIXTURE(GuardedHost, "nobody is armed for more than a day") {
  CHECK(host.arm(kShownCode, kMostArmed_min + 1).error == UnitError::bad_argument);
  CHECK(host.arm(kShownCode, kMostArmed_min).armed_s == 86'400);
}
