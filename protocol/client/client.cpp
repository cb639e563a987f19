// Typed reads, and commands of the host: given once, followed until they end.
#include "protocol/client/client.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

const Registers kEchoOnly{0};  ///< the link fills it in
constexpr Block kEchoAlone{kEcho.first, 1};
constexpr milliseconds kShortLimit = 5s;
constexpr milliseconds kStagingLimit = 60s;  ///< clearing or copying a whole bank
constexpr milliseconds kRamTestLimit = 10min;
constexpr milliseconds kFirstPoll = 5ms;
constexpr milliseconds kSlowestPoll = 200ms;
constexpr int kMostExchangeTries = 10;  ///< of a unit to which others at this address come too often
constexpr milliseconds kExchangePause = 150ms;
constexpr int kMostArmings = 3;  ///< for one command, of a unit that starts again and again

constexpr std::string_view kOpensByItself =
    "The unit opens its relays 60 s after the last request. The emergency stop is quicker.";

}  // namespace

UnitClient::UnitClient(Link link, const Host& host) : link_(std::move(link)) {
  self_.key = host.key != 0 ? host.key : chance_64();
  self_.number = static_cast<std::uint32_t>(chance_64());
  self_.host = host.name;
  arm_code_ = host.arm_code;
  secrets_ = host.secrets;
}

Result<UnitClient> UnitClient::connect(const LinkAddress& address, const LinkOptions& options, const Host& host) {
  ECS_TRY(link, Link::open(address, options));
  UnitClient client(std::move(link), host);
  auto answer = client.link_.ask(kEchoAlone, kEchoOnly, kIdentity);
  if (!answer && client.link_.last_failure() == LinkFailure::exception)  // another version may have a shorter one
    answer = client.link_.ask(kEchoAlone, kEchoOnly, kVersion);
  if (!answer) return tl::unexpected(std::move(answer.error()));
  if ((*answer)[1] != kProtocolVersion)
    return problem(
        ProblemKind::link,
        fmt::format("{}: the unit speaks protocol version {}, this program version {}; use matching versions",
                    to_text(address), (*answer)[1], kProtocolVersion));
  ECS_TRY(identity, value_in<Identity>(*answer));
  client.serial_number_ = identity.serial_number;
  return client;
}

Result<Identity> UnitClient::identity() {
  auto identity = link_.ask(kEchoAlone, kEchoOnly, kIdentity).and_then(value_in<Identity>);
  if (identity && serial_number_.empty()) serial_number_ = identity->serial_number;
  return identity;
}

Result<MonitorSample> UnitClient::monitor() {
  return link_.ask(kEchoAlone, kEchoOnly, kMonitor).and_then(value_in<MonitorSample>);
}

Result<LiveInputs> UnitClient::live_inputs() {
  return link_.ask(kEchoAlone, kEchoOnly, kInputs).and_then(value_in<LiveInputs>);
}

Result<ControlLines> UnitClient::control_lines() {
  return link_.ask(kEchoAlone, kEchoOnly, kControlLines).and_then(value_in<ControlLines>);
}

Result<RotarySample> UnitClient::rotary(const Identity& identity) {
  if (!shows_rotary(identity)) return RotarySample{};
  return link_.ask(kEchoAlone, kEchoOnly, kRotary).and_then(value_in<RotarySample>);
}

Result<UnitClient::ToolRecord> UnitClient::tool_record() {
  ECS_TRY(record, read_memory(kToolRecord.first, kToolRecord.size));
  return ToolRecord{stored_tools(record).value_or(ToolTable{}), damaged_tool_slots(record)};
}

Result<UnitStatus> UnitClient::status() {
  auto status = link_.ask(kEchoAlone, kEchoOnly, kStatus).and_then(value_in<UnitStatus>);
  if (!status) return status;
  ECS_TRY(pointers, link_.ask(kEchoAlone, kEchoOnly, kPointers));
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
  if (result.error == UnitError::bad_argument && !result.text.empty()) reason.clear();  // the text says which
  if (!result.text.empty()) reason += (reason.empty() ? "" : ": ") + result.text;
  switch (forgotten ? CommandState::idle : result.state) {
    case CommandState::done:
      return result;
    case CommandState::refused:
      if (result.error == UnitError::not_in_integration_mode)
        return problem(
            ProblemKind::refused,
            fmt::format("the unit does not accept \"{}\"{}. Run `ecs utility mode integrate`, then try again",
                        name_of(command.code), result.text.empty() ? "" : ": " + result.text));
      return problem(ProblemKind::refused, fmt::format("the unit refuses \"{}\": {}", name_of(command.code), reason));
    case CommandState::failed:
      return problem(ProblemKind::link, fmt::format("{} failed: {}", name_of(command.code), reason));
    default:
      return problem(ProblemKind::link,
                     fmt::format("{}: the unit no longer knows the command; was it restarted?", name_of(command.code)));
  }
}

Asker UnitClient::asker() { return key_ ? Asker{session_, ++challenge_} : Asker{}; }

bool UnitClient::is_sealed(const Registers& answer, const Block& block, std::uint32_t challenge) const {
  return key_ && check_at_end(answer) == answer_check(*key_, block, challenge, answer);
}

/// Asks once more where the key is not the unit's any more: with that of another program of this host, or armed again.
/// Who only reads goes on as a host that is not armed; who was armed to send a map must know whose answers it reads.
Result<UnitClient::Answer> UnitClient::ask_sealed(const Block& request,
                                                  const std::function<Registers(const Asker&)>& values,
                                                  const Block& answer) {
  if (sends_armed_ && (!key_ || session_ == 0)) ECS_DO(armed_session());
  for (bool again = false;; again = true) {
    const Asker who = asker();
    ECS_TRY(registers, link_.ask(request, values(who), answer));
    if (who.session == 0) return Answer{std::move(registers), !sends_armed_};
    if (is_sealed(registers, answer, who.challenge)) return Answer{std::move(registers), true};
    if (again) return Answer{std::move(registers), false};
    ECS_DO(session_now());
    if (!key_ && knows_code()) ECS_DO(armed_session());
    const bool only_reads = !sends_armed_ && (request == kReadSelect || request == kEcho);
    if (!key_ && !only_reads) return Answer{std::move(registers), false};
  }
}

/// Of an answer without the unit's check only a refusal counts that says why there is none.
Result<CommandResult> UnitClient::believed_result(const Answer& answer, CommandCode code) const {
  auto result = value_in<CommandResult>(answer.registers);
  if (!result || answer.believed || code == CommandCode::arm) return result;
  const bool says_why = result->error == UnitError::session_unknown || result->error == UnitError::not_armed ||
                        result->error == UnitError::wrong_key;
  if (says_why) return result;
  return problem(ProblemKind::link, fmt::format("{}: {}", name_of(code), kNotSealed));
}

Result<CommandResult> UnitClient::result_now() {
  ECS_TRY(answer, ask_sealed(
                      kResultSelect,
                      [this](const Asker& who) {
                        return registers_of(ResultSelect{key_ ? who : Asker{session_, 0}, sequence_}, 0);
                      },
                      kCommandResult));
  return believed_result(answer, CommandCode::none);
}

Result<CommandResult> UnitClient::exchange(const Command& command) {
  const bool in_session = command.asker.session != 0;
  const Registers values = sealed(registers_of(command, 0), Keyed::command, in_session ? key_ : std::nullopt);
  ECS_TRY(registers, link_.ask(kCommand, values, kCommandResult));
  const bool believed = !key_ || !in_session || is_sealed(registers, kCommandResult, command.asker.challenge);
  return believed_result({std::move(registers), believed}, command.code);
}

/// The key of the session, from this host's secret or from that which another of its programs has kept: whichever the
/// answer is sealed with.
bool UnitClient::adopt_key(const SessionState& state, const Registers& answer) {
  const auto kept = secrets_ ? secrets_->secret_of(serial_number_) : std::nullopt;
  for (const auto& secret : {secret_, kept}) {
    if (!secret) continue;
    key_ = session_key(*secret, state.session, state.nonce);
    if (!is_sealed(answer, kSession, self_.challenge)) continue;
    secret_ = secret;
    return true;
  }
  key_.reset();
  return false;
}

/// Opens the session of this client, or finds it again as the unit knows it now.
Result<SessionState> UnitClient::session_now() {
  if (serial_number_.empty()) ECS_DO(identity());
  self_.unix_time_s = static_cast<std::uint32_t>(link_.unix_time_s());
  self_.challenge = ++challenge_;
  ECS_TRY(answer, link_.ask(kSessionOpen, registers_of(self_, 0), kSession));
  auto state = value_in<SessionState>(answer);
  if (!state) return state;
  if (state->error == UnitError::other_version)
    return problem(ProblemKind::link,
                   fmt::format("the unit speaks protocol version {}, this program version {}; use matching versions",
                               state->protocol_version, kProtocolVersion));
  if (state->session == 0) return problem(ProblemKind::link, "the unit opens no session; is another host using it?");
  if (!adopt_key(*state, answer)) state->armed_s = 0;
  if (state->session != session_) sequence_ = state->sequence;
  session_ = state->session;
  sequence_ = std::max(sequence_, state->sequence);
  window_number_ = std::max(window_number_, state->window);
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

/// Session, number and, where the command acts at once, the unit's clock as it is now.
Result<void> UnitClient::make_ready(Command& command) {
  const bool armed = needs_arming(command.code);
  if (session_ == 0 || acts_at_once(command.code) || (armed && !key_)) {
    ECS_TRY(now, armed ? armed_session() : session_now());
    command.clock_ms = now.clock_ms;
    if (command.asker.session == 0)
      command.stops = now.stops;  // given again, it still is overtaken by a stop of before
  }
  command.asker = {session_, ++challenge_};
  command.sequence = ++sequence_;
  return {};
}

Result<CommandResult> UnitClient::run(Command command, std::chrono::milliseconds limit, const CommandCallback& busy) {
  const auto until = link_.now() + milliseconds(kMostAge_ms);
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
    const bool lapsed = (first->error == UnitError::not_armed && knows_code()) || first->error == UnitError::wrong_key;
    const bool had_key = key_.has_value();
    if (lapsed) ECS_DO(session_now());
    // Without a key any more it is given once more, and the unit says why it is refused.
    const bool other_key = lapsed && (key_ || had_key || knows_code());
    const bool not_taken = unknown ? !once : other_key || first->error == UnitError::late;
    if (!not_taken || link_.now() > until) return wait_for(command, std::move(*first), limit, busy);
  }
}

Result<CommandResult> UnitClient::wait_for(const Command& command, CommandResult result,
                                           std::chrono::milliseconds limit, const CommandCallback& busy) {
  const auto until = link_.now() + limit;
  milliseconds poll = kFirstPoll;
  const auto ours = [&] { return result.session == command.asker.session && result.sequence == command.sequence; };
  while (ours() && result.state == CommandState::busy) {
    if (busy) busy(result);
    const bool over = link_.now() >= until;
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
  return problem(ProblemKind::link, fmt::format("{}: {}{}", name_of(command.code),
                                                over ? "not finished in time, so it was stopped" : "cancelled",
                                                taken ? "" : fmt::format(" ({})", kStopNotReceived)));
}

Result<void> UnitClient::run_plain(const Command& command, std::chrono::milliseconds limit) {
  return run(command, limit).map([](const CommandResult&) {});
}

/// Of a command that acts on the machine: without an answer nobody knows whether it was done. That is said first, then
/// the remedy, then the cause.
Result<void> UnitClient::run_acting(const Command& command, std::chrono::milliseconds limit,
                                    std::string_view if_unanswered) {
  auto done = run_plain(command, limit);
  if (!done && done.error().kind == ProblemKind::link)
    done.error().message =
        fmt::format("The command may have been carried out. {} Cause: {}.", if_unanswered, done.error().message);
  return done;
}

Result<void> UnitClient::enter_integration() {
  return run_acting({.code = CommandCode::enter_integration}, kShortLimit,
                    "Assume that the unit is still compensating until its status shows otherwise.");
}

Result<void> UnitClient::enter_compensation() {
  return run_acting({.code = CommandCode::enter_compensation}, kRamTestLimit,
                    "The unit then compensates as soon as every axis is referenced. Read its status.");
}

Result<void> UnitClient::set_axis_position(Axis axis, double position_mm) {
  return run_acting({.code = CommandCode::set_axis_position, .axis = axis, .position_mm = position_mm}, kShortLimit,
                    "Compare the position with that of the control.");
}

Result<void> UnitClient::set_input(std::uint16_t input, double value) {
  return run_acting({.code = CommandCode::set_input, .input = input, .input_value = value}, kShortLimit,
                    "Read the inputs of the unit.");
}

namespace {
constexpr std::string_view kReadTools = "Read the table of tools of the unit.";
}  // namespace

Result<void> UnitClient::select_tool(std::uint16_t number) {
  return run_acting({.code = CommandCode::select_tool, .tool = number}, kShortLimit, kReadTools);
}
Result<void> UnitClient::set_tool(const Tool& tool) {
  return run_acting({.code = CommandCode::set_tool, .tool = tool.number, .tool_offset_mm = tool.offset_mm}, kShortLimit,
                    kReadTools);
}
Result<void> UnitClient::remove_tool(std::uint16_t number) {
  return run_acting({.code = CommandCode::remove_tool, .tool = number}, kShortLimit, kReadTools);
}
Result<void> UnitClient::replace_tools(std::span<const Tool> tools) {
  auto answer = run({.code = CommandCode::begin_tools}, kShortLimit);
  if (!answer && answer.error().kind == ProblemKind::refused &&
      answer.error().message.ends_with(text_of(UnitError::unknown_command)))
    answer.error().message += ". Set its tools one after the other: `ecs utility tool N --offset X,Y,Z`";
  ECS_DO(answer);
  ToolTable table;
  for (const Tool& tool : tools) {
    const Vector3 offset_mm = in_tool_steps(tool.offset_mm);
    ECS_DO(run({.code = CommandCode::stage_tool, .tool = tool.number, .tool_offset_mm = offset_mm}, kShortLimit));
    (void)put_tool(table, {tool.number, offset_mm});
  }
  return run_acting({.code = CommandCode::commit_tools,
                     .length = static_cast<std::uint32_t>(tools.size()),
                     .digest = tools_digest(table)},
                    kShortLimit, kReadTools);
}
Result<void> UnitClient::try_squareness(const Vector3& um_per_m) {
  return run_acting({.code = CommandCode::try_squareness, .squareness_um_per_m = um_per_m}, kShortLimit,
                    "Read which squareness the unit corrects.");
}

Result<void> UnitClient::output_compensation(Axis axis, double output_um, bool relay_on) {
  const Command command{
      .code = CommandCode::output_compensation, .axis = axis, .output_um = output_um, .relay_on = relay_on};
  return run_acting(
      command, kShortLimit,
      fmt::format("The relay of {} may be closed, and {} um may act. {}", letter_of(axis), output_um, kOpensByItself));
}

Result<void> UnitClient::output_off() {
  return run_acting({.code = CommandCode::output_off}, kShortLimit,
                    fmt::format("If it was not, a closed relay is still closed. {}", kOpensByItself));
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
  ECS_TRY(now, session_now());
  const ExchangeTerms terms = exchange_terms(code, serial_number_, session_, minutes);
  const HalfExchange own = half_exchange(terms);
  const auto refused = [](const ArmAnswer& answer) {
    const std::string wait = answer.wait_s > 0 ? fmt::format(": try again in {} s", answer.wait_s) : std::string();
    return problem(ProblemKind::refused, fmt::format("the unit refuses to arm: {}{}", text_of(answer.error), wait));
  };
  const auto share = [&] {
    return link_.ask(kArmShare, registers_of(ArmShare{session_, minutes, own.share}, 0), kArmAnswer)
        .and_then(value_in<ArmAnswer>);
  };
  auto shared_answer = share();
  for (int again = 0; again < kMostExchangeTries && shared_answer && shared_answer->error == UnitError::busy; ++again)
    if (link_.pause(kExchangePause)) shared_answer = share();
  ECS_TRY(shared, std::move(shared_answer));
  if (shared.error != UnitError::none) return refused(shared);
  const auto key = shared_key(terms, End::host, own, shared.share);
  if (!key) return problem(ProblemKind::link, "arm: the unit sent an invalid share; the unit is not armed");
  const ArmConfirm confirm{session_, confirmation_of(terms, End::host, *key, own.share)};
  ECS_TRY(answer, link_.ask(kArmConfirm, registers_of(confirm, 0), kArmAnswer).and_then(value_in<ArmAnswer>));
  if (answer.error != UnitError::none) return refused(answer);
  if (!same(answer.confirmation, confirmation_of(terms, End::unit, *key, shared.share)))
    return problem(ProblemKind::link,
                   "arm: the answer proves no knowledge of the code; another program answers in place of the unit");
  secret_ = secret_from(*key);
  key_ = session_key(*secret_, session_, now.nonce);
  armed_in_ = session_;
  if (secrets_) secrets_->keep(serial_number_, *secret_);
  return {};
}

Result<void> UnitClient::disarm() {
  ECS_DO(session_now());
  ECS_DO(run_plain({.code = CommandCode::arm}, kShortLimit));
  secret_.reset();
  key_.reset();
  return {};
}

Result<void> UnitClient::clear_fault() { return run_plain({.code = CommandCode::clear_fault}, kShortLimit); }

Result<void> UnitClient::reset_unit() {
  return run_acting({.code = CommandCode::reset_unit}, kShortLimit, "read the unit's status");
}

Result<std::uint32_t> UnitClient::check_memory(Address address, std::uint32_t bytes) {
  constexpr std::uint32_t kPiece = 0x4000;  ///< the unit's loop waits for no longer check
  std::uint32_t crc = 0;
  for (std::uint32_t at = 0; at < bytes || at == 0; at += kPiece) {
    const std::uint32_t length = std::min(kPiece, bytes - at);
    ECS_TRY(piece,
            run({.code = CommandCode::check_memory, .address = static_cast<Address>(address + at), .length = length},
                kShortLimit));
    crc = at == 0 ? piece.value : crc32_of_both(crc, piece.value, length);
  }
  return crc;
}

}  // namespace ecs::protocol
