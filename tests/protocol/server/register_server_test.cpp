// What a unit carries out, of all that comes over its link.
#include "protocol/server/register_server.hpp"

#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

struct ServedUnit {
  UnitModel model;
  RegisterServer server{model};
};
struct ServedHost : ServedUnit {
  RegisterHost host{server};
};

Command output_closed() {
  Command command{.code = CommandCode::output_compensation};
  command.output_um = 5.0;
  command.relay_on = true;
  return command;
}

}  // namespace

TEST_CASE_FIXTURE(ServedHost, "a command acts only when its whole block, with its check, comes in one request") {
  const auto block = host.sealed_registers(host.next(output_closed()));
  for (std::size_t i = 0; i < block.size(); ++i)
    CHECK(server.write(static_cast<std::uint16_t>(kCommand.first + i), std::span(block).subspan(i, 1)).has_value());
  CHECK(server.write(kCommand.first, std::span(block).first(block.size() - 1)).has_value());
  CHECK(server.write(kCommand.first + 1, std::span(block).subspan(1)).has_value());
  for (std::size_t i = 1; i < block.size(); ++i) {
    auto flipped = block;
    flipped[i] ^= 0x0010;
    (void)server.write(kCommand.first, flipped);
    CHECK(host.result().state != CommandState::done);
  }
  CHECK(model.commands_begun == 0);
  CHECK(server.write(kCommand.first, block).has_value());
  CHECK(model.commands_begun == 1);
}

TEST_CASE_FIXTURE(
    ServedHost, "a repeated command is answered as the first time, and a late repeat of an earlier one does nothing") {
  const Command begin = host.next({.code = CommandCode::begin_staging});
  const CommandResult first = host.send(begin);
  CHECK(first.state == CommandState::done);
  CHECK(host.send(begin) == first);
  (void)host.give({.code = CommandCode::clear_fault});
  CHECK(host.send(begin).state == CommandState::idle);
  CHECK(model.log == std::vector{CommandCode::begin_staging, CommandCode::clear_fault});
}

TEST_CASE_FIXTURE(ServedUnit, "each of two hosts reads the result of its own command") {
  RegisterHost one(server, 1);
  RegisterHost other(server, 2);
  CHECK(one.session() != other.session());
  const Command begin = one.next({.code = CommandCode::begin_staging});
  const CommandResult first = one.send(begin);
  (void)other.give({.code = CommandCode::clear_fault});
  REQUIRE(server.write(kResultSelect.first, registers_of(ResultSelect{begin.asker, begin.sequence}, 0)).has_value());
  CHECK(one.result() == first);
}

TEST_CASE_FIXTURE(
    ServedUnit,
    "a host whose program is asked again finds its session as it left it, another program gets one of its own") {
  RegisterHost host(server, 1);
  const auto session = host.session();
  (void)host.give({.code = CommandCode::clear_fault});
  CHECK(host.look().session == session);
  CHECK(host.look().sequence == 1);
  RegisterHost other(server, 2);
  CHECK(other.session() != session);
  CHECK(other.look().sequence == 0);
}

TEST_CASE("a command that was given before everything was switched off is not carried out after it") {
  for (const CommandCode off : {CommandCode::output_off, CommandCode::stop, CommandCode::enter_integration}) {
    UnitModel model;
    RegisterServer server(model);
    RegisterHost a(server, 1);
    RegisterHost b(server, 2);
    (void)a.look();
    const Command lost = a.next(output_closed());  // its first try never arrives
    CHECK(b.give({.code = off}).state == CommandState::done);
    CHECK(a.send(lost).error == UnitError::overtaken);
    CHECK(model.log == std::vector{off});
    CHECK(a.give(output_closed()).state == CommandState::done);
  }
}

TEST_CASE_FIXTURE(
    ServedUnit,
    "a retry after another host switched everything off gives the answer of the first time and closes nothing") {
  RegisterHost a(server, 1);
  RegisterHost b(server, 2);
  (void)a.look();
  const Command output = a.next(output_closed());
  CHECK(a.send(output).state == CommandState::done);
  (void)b.give({.code = CommandCode::output_off});
  CHECK(a.send(output).state == CommandState::done);
  CHECK(model.log == std::vector{CommandCode::output_compensation, CommandCode::output_off});
}

TEST_CASE("what moves or closes a relay lives for two seconds of the unit's clock") {
  for (const CommandCode code :
       {CommandCode::output_compensation, CommandCode::enter_compensation, CommandCode::set_axis_position,
        CommandCode::test_datum, CommandCode::run_user_software, CommandCode::reset_unit}) {
    UnitModel model;
    RegisterServer server(model);
    RegisterHost host(server);
    (void)host.look();
    model.unit_clock.ms += kMostAge_ms + 1;
    CHECK(host.send(host.next({.code = code})).error == UnitError::late);
    CHECK(model.commands_begun == 0);
    (void)host.look();
    model.unit_clock.ms += kMostAge_ms;
    CHECK(host.send(host.next({.code = code})).error == UnitError::none);
    CHECK(model.commands_begun == 1);
    (void)host.look();
    model.unit_clock.ms -= 1;  // of a start before
    CHECK(host.send(host.next({.code = CommandCode::clear_fault})).error != UnitError::none);
  }
}

TEST_CASE_FIXTURE(ServedHost, "switching off has no age") {
  (void)host.arm("", kMostArmed_min);
  model.unit_clock.ms += 3'600'000;
  for (const CommandCode code : {CommandCode::output_off, CommandCode::stop, CommandCode::enter_integration})
    CHECK(host.send(host.next({.code = code})).state == CommandState::done);
}

TEST_CASE_FIXTURE(ServedHost, "a unit that has started again knows no session, no token and no result of before") {
  const auto before = host.session();
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  ++model.unit_clock.starts;
  Command commit = host.next({.code = CommandCode::commit_staged, .length = 4, .token = token});
  CHECK(host.send(commit).error == UnitError::session_unknown);
  CHECK(host.look().session != before);
  CHECK(host.give({.code = CommandCode::abandon_staged, .token = token}).error == UnitError::no_staging);
}

TEST_CASE("the session used least lately gives way to one too many, that of an armed host last") {
  UnitModel model;
  RegisterServer server(model, {"271828", true});
  RegisterHost first(server, 100), armed(server, 101);
  (void)armed.arm("271828");
  for (std::uint32_t k = 2; k < kSessions; ++k) RegisterHost(server, k);
  const auto session = first.session();
  for (std::uint32_t k = 1; k < 20; ++k) RegisterHost(server, 101, k);  // that name the armed host, without its key
  CHECK(first.look().session != session);
  CHECK(armed.give({.code = CommandCode::clear_fault}).state == CommandState::done);
  for (std::uint32_t k = 1; k <= kSessions; ++k) RegisterHost(server, 200 + k);
  CHECK(first.send(first.next({.code = CommandCode::clear_fault})).error == UnitError::session_unknown);
  CHECK(armed.give({.code = CommandCode::clear_fault}).state == CommandState::done);
}

TEST_CASE("sessions of a stranger by the thousand take that of no host from elsewhere") {
  UnitModel model;
  RegisterServer server(model, {"271828", true});
  server.arrives_on(1, "host");
  RegisterHost host(server, 1);
  const auto session = host.session();
  server.arrives_on(2, "stranger");
  for (std::uint32_t k = 0; k < 1000; ++k) RegisterHost(server, 100 + k);
  server.arrives_on(1, "host");
  CHECK(host.arm("271828").error == UnitError::none);
  CHECK(host.session() == session);
}

TEST_CASE("sessions that the programs of an armed host have left keep no other host out") {
  UnitModel model;
  RegisterServer server(model, {"271828", true});
  RegisterHost armed(server, 1);
  CHECK(armed.arm("271828").error == UnitError::none);
  for (std::uint32_t number = 1; number < 2 * kSessions; ++number) {
    RegisterHost program(server, 1, number);
    program.share_with(armed);
    CHECK(program.give({.code = CommandCode::clear_fault}).state == CommandState::done);
  }
  std::vector<RegisterHost> others;
  for (std::uint32_t k = 0; k < kSessions - kKeptForArmed; ++k) others.emplace_back(server, 100 + k);
  for (RegisterHost& other : others)
    CHECK(other.send(other.next({.code = CommandCode::check_memory})).error != UnitError::session_unknown);
}

TEST_CASE("commands on many connections of strangers take the place of no armed host") {
  UnitModel model;
  RegisterServer server(model, {"271828", true});
  RegisterHost armed(server, 1), stranger(server, 2);
  server.arrives_on(1, "armed");
  (void)armed.arm("271828");
  for (std::uint64_t connection = 2; connection < 3 * kSessions; ++connection) {
    server.arrives_on(connection, "stranger");
    (void)stranger.give({.code = CommandCode::abandon_staged});
    CHECK(server.speaks_on(connection) == RegisterHandler::Speaks::commander);
  }
  CHECK(server.speaks_on(1) == RegisterHandler::Speaks::armed);
  CHECK(server.speaks_on(2) == RegisterHandler::Speaks::reader);  // forgotten
}

TEST_CASE_FIXTURE(ServedUnit,
                  "a host of another protocol version gets no session, and the unit names its own version") {
  const SessionOpen newer{0, kProtocolVersion + 1, 7, 7, 0, "from tomorrow"};
  REQUIRE(server.write(kSessionOpen.first, registers_of(newer, 0)).has_value());
  const auto state = value_in<SessionState>(server.read(kSession.first, kSession.count).value()).value();
  CHECK(state.error == UnitError::other_version);
  CHECK(state.session == 0);
  CHECK(state.protocol_version == kProtocolVersion);
}

TEST_CASE_FIXTURE(ServedHost, "a command whose number or fields make no sense is refused and does nothing") {
  (void)host.look();
  Command strange = host.next({.code = CommandCode::clear_fault});
  strange.code = static_cast<CommandCode>(kCommandCount + 3);
  CHECK(host.send(strange).error == UnitError::unknown_command);
  Command axis = host.next({.code = CommandCode::set_axis_position});
  axis.axis = static_cast<Axis>(9);
  CHECK(host.send(axis).error == UnitError::bad_argument);
  CHECK(host.give({.code = CommandCode::check_memory, .address = kBankA.first, .length = 0}).error ==
        UnitError::bad_argument);
  CHECK(host.give({.code = CommandCode::check_memory, .address = 0x900000, .length = 4}).error ==
        UnitError::address_unknown);
  CHECK(model.commands_begun == 0);
}

TEST_CASE_FIXTURE(ServedHost, "checks of no bytes, of too many pieces, of no memory and for strangers are exceptions") {
  const auto refusal = [&](CheckSelect select, bool armed = true) {
    select.asker = {armed ? host.session() : 0, 1};
    REQUIRE(server.write(kCheckSelect.first, registers_of(select, 0)).has_value());
    const auto answer = server.read(kChecks.first, kChecks.count);
    return answer ? std::optional<ModbusException>() : answer.error();
  };
  CHECK(refusal({{}, kBankA.first, 0, 480}) == ModbusException::illegal_value);
  CHECK(refusal({{}, kBankA.first, 480, 0}) == ModbusException::illegal_value);
  CHECK(refusal({{}, kBankA.first, 31 * 480, 480}) == ModbusException::illegal_value);
  CHECK(refusal({{}, 0x900000, 480, 480}) == ModbusException::illegal_address);
  CHECK_FALSE(refusal({{}, kBankA.first, 30 * 480, 480}));
  CHECK(refusal({{}, kBankA.first, 480, 480}, false) == ModbusException::illegal_value);
}
