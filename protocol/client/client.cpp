// Typed reads, and commands of the host: given once, followed until they end.
#include "protocol/client/client.hpp"

#include <algorithm>
#include <ctime>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

const Registers kEchoOnly{0};  ///< the link fills it in
constexpr milliseconds kShortLimit = 5s;
constexpr milliseconds kStagingLimit = 60s;  ///< clearing or copying a whole bank
constexpr milliseconds kRamTestLimit = 10min;
constexpr milliseconds kFirstPoll = 5ms;
constexpr milliseconds kSlowestPoll = 200ms;
constexpr int kMostArmings = 3;  ///< for one command, of a unit that starts again and again

constexpr std::string_view kOpensByItself =
    "the unit opens its relays 60 s after the last request; the emergency stop is quicker";

}  // namespace

UnitClient::UnitClient(Link link, const Host& host) : link_(std::move(link)) {
  std::random_device chance;
  self_.key = host.key != 0 ? host.key : std::uint64_t{chance()} << 32 | chance();
  self_.number = chance();
  self_.host = host.name;
  arm_code_ = host.arm_code;
}

Result<UnitClient> UnitClient::connect(const LinkAddress& address, const LinkOptions& options, const Host& host) {
  ECS_TRY(link, Link::open(address, options));
  UnitClient client(std::move(link), host);
  ECS_TRY(version, client.link_.ask(kEcho, kEchoOnly, kVersion));
  if (version[1] != kProtocolVersion)
    return problem(
        ProblemKind::link,
        fmt::format("{}: the unit speaks protocol version {}, this program version {}; use matching versions",
                    to_text(address), version[1], kProtocolVersion));
  ECS_DO(client.identity());
  return client;
}

Result<Identity> UnitClient::identity() {
  auto identity = link_.ask(kEcho, kEchoOnly, kIdentity).and_then(value_in<Identity>);
  if (identity && serial_number_.empty()) serial_number_ = identity->serial_number;
  return identity;
}

Result<MonitorSample> UnitClient::monitor() {
  return link_.ask(kEcho, kEchoOnly, kMonitor).and_then(value_in<MonitorSample>);
}

Result<UnitStatus> UnitClient::status() {
  auto status = link_.ask(kEcho, kEchoOnly, kStatus).and_then(value_in<UnitStatus>);
  if (!status) return status;
  ECS_TRY(pointers, link_.ask(kEcho, kEchoOnly, kPointers));
  ECS_DO(take_pointers(pointers, *status));
  return status;
}

Result<std::vector<Registers>> UnitClient::event_blocks(std::size_t most) {
  std::vector<Registers> blocks;
  if (most == 0) return blocks;
  const auto asked = [this](std::uint32_t first) {
    return link_.ask(kEventSelect, registers_of(EventSelect{first}, 0), kEvents);
  };
  ECS_TRY(newest, asked(std::numeric_limits<std::uint32_t>::max()).and_then(value_in<EventPage>));
  std::uint32_t next = newest.newest > most ? newest.newest - static_cast<std::uint32_t>(most) + 1 : 1;
  while (next <= newest.newest) {
    ECS_TRY(block, asked(next));
    ECS_TRY(page, value_in<EventPage>(block));
    const std::uint32_t last =
        std::max_element(page.events.begin(), page.events.end(), [](const auto& a, const auto& b) {
          return a.number < b.number;
        })->number;
    if (last < next) return blocks;
    next = last + 1;
    blocks.push_back(std::move(block));
  }
  return blocks;
}

/// In words, with what this client knows of its arming.
std::string UnitClient::reason_of(UnitError error) const {
  if (error != UnitError::not_armed || armed_in_ == 0) return std::string(text_of(error));
  return fmt::format("{}; {}",
                     armed_in_ == session_ ? "the time for which this host was armed has ended"
                                           : "the unit was restarted since this host was armed",
                     text_of(error));
}

Result<CommandResult> UnitClient::outcome_of(const Command& command, const CommandResult& result) const {
  const bool forgotten = result.error == UnitError::session_unknown;
  std::string reason = result.error == UnitError::none ? std::string() : reason_of(result.error);
  if (!result.text.empty()) reason += (reason.empty() ? "" : ": ") + result.text;
  switch (forgotten ? CommandState::idle : result.state) {
    case CommandState::done:
      return result;
    case CommandState::refused:
      return problem(ProblemKind::refused, fmt::format("the unit refuses to {}: {}", name_of(command.code), reason));
    case CommandState::failed:
      return problem(ProblemKind::link, fmt::format("{} failed: {}", name_of(command.code), reason));
    default:
      return problem(ProblemKind::link,
                     fmt::format("{}: the unit no longer knows the command; was it restarted?", name_of(command.code)));
  }
}

Result<CommandResult> UnitClient::result_now() {
  return link_.ask(kResultSelect, registers_of(ResultSelect{session_, sequence_}, 0), kCommandResult)
      .and_then(value_in<CommandResult>);
}

Result<CommandResult> UnitClient::exchange(const Command& command) {
  return link_.ask(kCommand, registers_of(command, 0), kCommandResult).and_then(value_in<CommandResult>);
}

/// Opens the session of this client, or finds it again as the unit knows it now.
Result<SessionState> UnitClient::session_now() {
  self_.unix_time_s = static_cast<std::uint32_t>(std::time(nullptr));
  auto state = link_.ask(kSessionOpen, registers_of(self_, 0), kSession).and_then(value_in<SessionState>);
  if (!state) return state;
  if (state->error == UnitError::other_version)
    return problem(ProblemKind::link,
                   fmt::format("the unit speaks protocol version {}, this program version {}; use matching versions",
                               state->protocol_version, kProtocolVersion));
  if (state->session == 0) return problem(ProblemKind::link, "the unit opens no session; is another host using it?");
  if (state->session != session_) sequence_ = state->sequence;
  session_ = state->session;
  if (state->armed_s > 0) armed_in_ = session_;
  return state;
}

/// The session as it is now, armed if the code is known; once more where the unit starts between arming and looking.
Result<SessionState> UnitClient::armed_session() {
  auto now = session_now();
  for (int armings = 0; now && now->armed_s == 0 && knows_code(); ++armings) {
    if (armings == kMostArmings)
      return problem(ProblemKind::link,
                     "the unit is armed, but restarts each time; check its power supply and its faults");
    const std::string code = std::exchange(arm_code_, {});
    const auto done = arm(code);
    wants_code_ = !done && done.error().kind == ProblemKind::refused;
    if (!wants_code_) arm_code_ = code;  // a wrong one is not shown again
    if (!done) return tl::unexpected(done.error());
    armed_in_ = session_;
    now = session_now();
  }
  return now;
}

/// Session, number, proof and, where the command acts at once, the unit's clock as it is now.
Result<void> UnitClient::make_ready(Command& command) {
  if (session_ == 0 || needs_arming(command.code)) {
    ECS_TRY(now, needs_arming(command.code) ? armed_session() : session_now());
    command.clock_ms = now.clock_ms;
    if (command.session == 0) command.stops = now.stops;  // given again, it still is overtaken by a stop of before
  }
  command.session = session_;
  command.sequence = ++sequence_;
  if (command.code == CommandCode::arm) command.proof = arm_proof(code_in_proof_, session_);
  return {};
}

Result<CommandResult> UnitClient::run(Command command, std::chrono::milliseconds limit, const CommandCallback& busy) {
  const auto until = std::chrono::steady_clock::now() + milliseconds(kMostAge_ms);
  for (;;) {
    ECS_DO(make_ready(command));
    auto first = exchange(command);
    if (!first && link_.cancelled()) return stopped(command, false);  // it may have arrived
    if (!first) return first;
    const bool unknown = first->error == UnitError::session_unknown;
    if (unknown) session_ = 0;
    if (first->error == UnitError::not_armed) wants_code_ = true;
    // A session that was there just before: the unit has started, and may have carried the command out before that,
    // which counts but for a staging, whose end the start was.
    const bool once = needs_arming(command.code) && command.code != CommandCode::begin_staging;
    const bool lapsed = first->error == UnitError::not_armed && knows_code();
    const bool not_taken = unknown ? !once : lapsed || first->error == UnitError::late;
    if (!not_taken || std::chrono::steady_clock::now() > until)
      return wait_for(command, std::move(*first), limit, busy);
  }
}

Result<CommandResult> UnitClient::wait_for(const Command& command, CommandResult result,
                                           std::chrono::milliseconds limit, const CommandCallback& busy) {
  const auto until = std::chrono::steady_clock::now() + limit;
  milliseconds poll = kFirstPoll;
  const auto ours = [&] { return result.session == command.session && result.sequence == command.sequence; };
  while (ours() && result.state == CommandState::busy) {
    if (busy) busy(result);
    const bool over = std::chrono::steady_clock::now() >= until;
    if (over || !link_.pause(poll)) return stopped(command, over);
    poll = std::min(2 * poll, kSlowestPoll);
    auto next = result_now();
    if (!next && link_.cancelled()) return stopped(command, false);
    if (!next) return next;
    result = std::move(*next);
  }
  if (!ours())
    return problem(ProblemKind::link,
                   fmt::format("{}: the unit answers a different command; it was restarted, or another host uses it",
                               name_of(command.code)));
  return outcome_of(command, result);
}

/// Ends a command that is taking too long, or that is no longer wanted.
Result<CommandResult> UnitClient::stopped(const Command& command, bool over) {
  link_.heed_cancel(false);
  Command stop{.code = CommandCode::stop};
  const auto taken = make_ready(stop).and_then([&] { return exchange(stop); });
  link_.heed_cancel(true);
  return problem(ProblemKind::link,
                 fmt::format("{}: {}{}", name_of(command.code), over ? "not done in time; stopped" : "cancelled",
                             taken ? "" : fmt::format(" ({})", kStopNotReceived)));
}

Result<void> UnitClient::run_plain(const Command& command, std::chrono::milliseconds limit) {
  return run(command, limit).map([](const CommandResult&) {});
}

/// Of a command that acts on the machine: without an answer nobody knows whether it was done, and that is said.
Result<void> UnitClient::run_acting(const Command& command, std::chrono::milliseconds limit,
                                    std::string_view if_unanswered) {
  auto done = run_plain(command, limit);
  if (!done && done.error().kind == ProblemKind::link)
    done.error().message += fmt::format("; it may have been carried out: {}", if_unanswered);
  return done;
}

Result<void> UnitClient::enter_integration() {
  return run_acting({.code = CommandCode::enter_integration}, kShortLimit,
                    "assume that it is still compensating until its status shows otherwise");
}

Result<void> UnitClient::enter_compensation() {
  return run_acting({.code = CommandCode::enter_compensation}, kRamTestLimit,
                    "the unit then closes its relays as soon as every axis is referenced; read its status");
}

Result<void> UnitClient::set_axis_position(Axis axis, double position_mm) {
  return run_acting({.code = CommandCode::set_axis_position, .axis = axis, .position_mm = position_mm}, kShortLimit,
                    "compare the position with the control's");
}

Result<void> UnitClient::output_compensation(Axis axis, double output_um, bool relay_on) {
  const Command command{
      .code = CommandCode::output_compensation, .axis = axis, .output_um = output_um, .relay_on = relay_on};
  return run_acting(command, kShortLimit,
                    fmt::format("the relay of {} may be closed, or still be closed, and {} um may act; {}",
                                letter_of(axis), output_um, kOpensByItself));
}

Result<void> UnitClient::output_off() {
  return run_acting({.code = CommandCode::output_off}, kShortLimit,
                    fmt::format("if it was not, a closed relay is still closed; {}", kOpensByItself));
}

Result<Address> UnitClient::begin_staging(StagingFrom from) {
  return run({.code = CommandCode::begin_staging, .staging_from = from}, kStagingLimit)
      .map([this](const CommandResult& result) {
        token_ = result.token;
        return Address{result.value};
      });
}

Result<void> UnitClient::abandon_staged() {
  return run_plain({.code = CommandCode::abandon_staged, .token = token_}, kShortLimit);
}

Result<CommandResult> UnitClient::test_datum(Axis axis, std::chrono::milliseconds limit, const CommandCallback& busy) {
  return run({.code = CommandCode::test_datum, .axis = axis}, limit, busy);
}

Result<CommandResult> UnitClient::record_datum(Axis axis, std::chrono::milliseconds limit,
                                               const CommandCallback& busy) {
  return run({.code = CommandCode::record_datum, .axis = axis}, limit, busy);
}

Result<std::uint32_t> UnitClient::run_user_software(Address address, std::uint32_t argument,
                                                    std::chrono::milliseconds limit) {
  return run({.code = CommandCode::run_user_software, .address = address, .argument = argument}, limit)
      .map([](const CommandResult& result) { return result.value; });
}

Result<CommandResult> UnitClient::run_ram_test(const CommandCallback& busy) {
  return run({.code = CommandCode::run_ram_test}, kRamTestLimit, busy);
}

Result<std::uint32_t> UnitClient::armed_s() {
  return session_now().map([](const SessionState& now) { return now.armed_s; });
}

Result<void> UnitClient::arm(const std::string& code, std::uint16_t minutes) {
  code_in_proof_ = code;
  return run_plain({.code = CommandCode::arm, .minutes = minutes}, kShortLimit);
}

Result<void> UnitClient::disarm() { return run_plain({.code = CommandCode::arm}, kShortLimit); }

Result<void> UnitClient::clear_fault() { return run_plain({.code = CommandCode::clear_fault}, kShortLimit); }

Result<void> UnitClient::reset_unit() {
  return run_acting({.code = CommandCode::reset_unit}, kShortLimit, "read the unit's status");
}

Result<std::uint32_t> UnitClient::check_memory(Address address, std::uint32_t bytes) {
  return run({.code = CommandCode::check_memory, .address = address, .length = bytes}, kStagingLimit)
      .map([](const CommandResult& result) { return result.value; });
}

}  // namespace ecs::protocol
