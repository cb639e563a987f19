// Registers read and written, as the unit understands them.
#include "protocol/server/register_server.hpp"

#include <algorithm>
#include <vector>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {
namespace {

constexpr std::array kAnswers{kIdentity,  kStatus,    kMonitor, kPointers,     kCommandResult,
                              kWindowAck, kMemory,    kChecks,  kSession,      kEvents,
                              kActiveMap, kArmAnswer, kInputs,  kControlLines, kRotary};
constexpr std::array kEchoed{kEcho,         kReadSelect,  kCheckSelect, kWindowOpen, kCommand,
                             kResultSelect, kSessionOpen, kEventSelect, kArmShare,   kArmConfirm};
constexpr std::array kWithCheck{kSessionOpen, kArmShare, kArmConfirm};
/// What names a session; never read back, and its answer is given once.
constexpr std::array kOfSession{kWindowOpen,  kCommand,  kResultSelect, kSessionOpen,
                                kCheckSelect, kArmShare, kArmConfirm};
constexpr std::array kSealed{kCommandResult, kWindowAck, kSession, kActiveMap};
constexpr std::array kAskers{kEcho, kWindowOpen, kCommand, kResultSelect, kCheckSelect};
constexpr std::size_t kAskerAt = 1, kAskerInReadSelect = 4;

Asker asker_in(std::span<const std::uint16_t> block, std::size_t at) {
  const auto number = [&](std::size_t i) { return static_cast<std::uint32_t>(block[i]) << 16 | block[i + 1]; };
  return {number(at), number(at + 2)};
}

ActiveMap active_map_of(UnitPort& unit) {
  const UnitStatus status = unit.status();
  return {unit.identity().serial_number, status.block_check_expected, status.block_check_found, status.active_bank,
          status.commit_sequence,        status.image_length_bytes,   unit.active_digest()};
}

bool is_one_of(const auto& blocks, const Block& block) {
  return std::find(blocks.begin(), blocks.end(), block) != blocks.end();
}
constexpr std::uint64_t kPlaceAfterCommand_ms = 60'000;
constexpr std::uint32_t kLongestCheck = 0x4000;  ///< so that the loop waits for no check

std::optional<Block> answer_block(std::uint16_t first, std::uint16_t count) {
  for (const Block& block : kAnswers)
    if (block.contains(first, count)) return block;
  return std::nullopt;
}

std::optional<Block> request_block(std::uint16_t first, std::size_t count) {
  for (const Block& block : kEchoed)
    if (block.contains(first, static_cast<std::uint32_t>(count))) return block;
  return std::nullopt;
}

CommandResult refused(UnitError error) { return {0, CommandState::refused, error, 0, 0, {}}; }

}  // namespace

tl::expected<Registers, ModbusException> RegisterServer::read(std::uint16_t first, std::uint16_t count) {
  const Asker asker = std::exchange(asker_, Asker{});
  if (first + std::uint32_t{count} <= requests_.size())
    return Registers(requests_.begin() + first, requests_.begin() + first + count);
  const auto block = answer_block(first, count);
  if (!block) return tl::unexpected(ModbusException::illegal_address);
  Registers whole;
  if (*block == kMemory || *block == kChecks) {
    auto of_memory = *block == kMemory ? memory_answer(asker) : checks_answer(asker);
    if (!of_memory) return of_memory;
    whole = std::move(*of_memory);
  } else {
    whole = answer(*block);
    if (is_one_of(kSealed, *block)) seal(whole, *block, asker);
  }
  const auto from = whole.begin() + (first - block->first);
  return Registers(from, from + count);
}

RegisterHandler::Speaks RegisterServer::speaks_on(std::uint64_t connection) {
  const auto its = std::find_if(speakers_.begin(), speakers_.end(),
                                [connection](const Speaker& speaker) { return speaker.connection == connection; });
  if (its == speakers_.end()) return Speaks::reader;
  if (key_of(its->session)) return Speaks::armed;
  return unit_->clock().ms - its->commanded_ms <= kPlaceAfterCommand_ms ? Speaks::commander : Speaks::reader;
}

/// The session that gave a command, on the connection at hand. Armed hosts are the last to be forgotten.
void RegisterServer::note_speaker(std::uint32_t session) {
  std::erase_if(speakers_, [this](const Speaker& speaker) { return speaker.connection == connection_; });
  speakers_.push_back({connection_, session, unit_->clock().ms});
  if (speakers_.size() <= kSessions) return;
  const auto first = std::find_if(speakers_.begin(), speakers_.end(),
                                  [this](const Speaker& speaker) { return !key_of(speaker.session); });
  speakers_.erase(first == speakers_.end() ? speakers_.begin() : first);
}

std::optional<Secret> RegisterServer::key_of(std::uint32_t session_id) {
  const HostSession* session = sessions_.find(session_id);
  return session == nullptr ? std::nullopt : arming_.key_of(*session, unit_->clock().ms);
}

/// The check of an answer to a host that has a key; zeros for everybody else.
void RegisterServer::seal(Registers& answer, const Block& block, const Asker& asker) {
  if (const auto key = key_of(asker.session)) put_check(answer, answer_check(*key, block, asker.challenge, answer));
}

Registers RegisterServer::answer(const Block& block) {
  if (block == kIdentity) return registers_of(unit_->identity(), echo_);
  if (block == kStatus) return registers_of(unit_->status(), echo_);
  if (block == kActiveMap) return registers_of(active_map_of(*unit_), echo_);
  if (block == kMonitor) return registers_of(unit_->monitor(), echo_);
  if (block == kInputs) return registers_of(unit_->live_inputs(), echo_);
  if (block == kControlLines) return registers_of(unit_->control_lines(), echo_);
  if (block == kRotary) return registers_of(unit_->rotary(), echo_);
  if (block == kPointers) return pointer_registers_of(unit_->status(), echo_);
  if (block == kCommandResult) return registers_of(result_selected(), echo_);
  if (block == kSession) return registers_of(session_asked(), echo_);
  if (block == kEvents) {
    note_what_has_ended();
    return registers_of(events_.page(event_select_.first), echo_);
  }
  const Block asked = std::exchange(asked_, Block{});
  if (block == kArmAnswer)
    return registers_of(asked == kArmShare || asked == kArmConfirm ? arming_answer_ : ArmAnswer{}, echo_);
  return registers_of(asked == kWindowOpen && refused_window_ ? *refused_window_ : window_.ack(), echo_);
}

tl::expected<Registers, ModbusException> RegisterServer::memory_answer(const Asker& asker) {
  const auto select = value_in<ReadSelect>(std::span(requests_).subspan(kReadSelect.first, kReadSelect.count));
  const std::size_t most = asker.session == 0 ? kMemoryBytes : kKeyedMemoryBytes;
  if (!select || select->bytes == 0 || select->bytes > most) return tl::unexpected(ModbusException::illegal_value);
  std::vector<std::uint8_t> bytes(select->bytes);
  if (unit_->read_memory(select->address, bytes) != UnitError::none)
    return tl::unexpected(ModbusException::illegal_address);
  Registers registers = registers_of(MemoryHead{select->address, crc32_of(bytes)}, echo_);
  const Registers data = packed(bytes);
  registers.insert(registers.end(), data.begin(), data.end());
  if (asker.session != 0) {
    registers.resize(registers.size() + kKeyedCheckRegisters, 0);
    seal(registers, kMemory, asker);
  }
  registers.resize(kMemory.count, 0);
  return registers;
}

/// Only for a host that is armed: to nobody else the checks say anything, and they take their time.
tl::expected<Registers, ModbusException> RegisterServer::checks_answer(const Asker& asker) {
  const auto key = std::exchange(asked_, Block{}) == kCheckSelect ? key_of(asker.session) : std::nullopt;
  const CheckSelect& select = check_select_;
  const bool possible = key && select.length > 0 && select.length <= kLongestCheck && select.piece > 0;
  if (!possible || (select.length - 1) / select.piece >= kMostChecks)
    return tl::unexpected(ModbusException::illegal_value);
  Registers registers{echo_};
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t at = 0; at < select.length; at += select.piece) {
    bytes.resize(std::min<std::uint32_t>(select.piece, select.length - at));
    if (unit_->read_memory(select.address + at, bytes) != UnitError::none)
      return tl::unexpected(ModbusException::illegal_address);
    registers.resize(registers.size() + kKeyedCheckRegisters, 0);
    put_check(registers, piece_check(*key, select.address + at, bytes));
  }
  registers.resize(registers.size() + kKeyedCheckRegisters, 0);
  seal(registers, kChecks, asker);
  registers.resize(kChecks.count, 0);
  return registers;
}

tl::expected<void, ModbusException> RegisterServer::write(std::uint16_t first, std::span<const std::uint16_t> values) {
  asker_ = {};
  if (first == kBlockWrite.first && values.size() <= kBlockWrite.count) {
    if (!take_block(values)) return tl::unexpected(ModbusException::illegal_value);
    return {};
  }
  const auto block = request_block(first, values.size());
  if (!block) return tl::unexpected(ModbusException::illegal_address);
  const bool whole = block->count > 1 && first == block->first && values.size() == block->count;
  if (whole && is_one_of(kWithCheck, *block) && !check_agrees(values))
    return tl::unexpected(ModbusException::illegal_value);
  if (!is_one_of(kOfSession, *block)) std::copy(values.begin(), values.end(), requests_.begin() + first);
  if (first == block->first) echo_ = values.front();
  if (block->end() <= requests_.size()) requests_[block->first] = echo_;
  if (whole) act_on(*block, values);
  return {};
}

/// A block that comes on another connection than the window is not looked at: who could open the window there, knowing
/// its session and token, has not.
bool RegisterServer::take_block(std::span<const std::uint16_t> block) {
  forget_hosts_of_another_start();
  if (connection_ != window_connection_) return false;
  const auto key = key_of(window_.session());
  if (!key) window_.refuse(UnitError::not_armed);
  const bool was_open = window_.error() == UnitError::none;
  if (window_.take(block, key)) return true;
  if (was_open && window_.error() == UnitError::check_mismatch)
    if (const HostSession* session = sessions_.find(window_.session()))
      note_window(*session, window_.window(), UnitError::check_mismatch);
  return false;
}

/// After a start of the unit nothing of before counts: sessions, tokens, results.
void RegisterServer::forget_hosts_of_another_start() {
  const std::uint32_t starts = unit_->clock().starts;
  if (starts == starts_) return;
  starts_ = starts;
  sessions_.forget_all();
  arming_.begin_again();
  window_.stage_under(0);
  port_busy_ = false;
}

void RegisterServer::act_on(const Block& block, std::span<const std::uint16_t> whole) {
  asked_ = block;
  if (is_one_of(kAskers, block)) asker_ = asker_in(whole, kAskerAt);
  if (block == kReadSelect) asker_ = asker_in(whole, kAskerInReadSelect);
  note_what_has_ended();
  if (block == kSessionOpen) {
    if (const auto host = value_in<SessionOpen>(whole)) open_session(*host);
  } else if (block == kWindowOpen) {
    if (const auto window = value_in<WindowOpen>(whole)) open_window(*window, whole);
  } else if (block == kResultSelect) {
    if (const auto select = value_in<ResultSelect>(whole)) selected_ = *select;
  } else if (block == kCheckSelect) {
    if (const auto select = value_in<CheckSelect>(whole)) check_select_ = *select;
  } else if (block == kEventSelect) {
    if (const auto select = value_in<EventSelect>(whole)) event_select_ = *select;
  } else if (block == kArmShare) {
    if (const auto arm = value_in<ArmShare>(whole)) begin_arming(*arm);
  } else if (block == kArmConfirm) {
    if (const auto arm = value_in<ArmConfirm>(whole)) confirm_arming(*arm);
  } else if (block == kCommand) {
    if (const auto command = value_in<Command>(whole)) return take_command(*command, whole);
    constexpr std::size_t kSequence = 5, kCode = 7;
    Command unreadable;
    unreadable.asker = asker_;
    unreadable.sequence = static_cast<std::uint32_t>(whole[kSequence]) << 16 | whole[kSequence + 1];
    unreadable.code = whole[kCode] < kCommandCount ? CommandCode::none : static_cast<CommandCode>(kCommandCount);
    take_command(unreadable, whole);
  }
}

/// The host's time when the unit's clock was 0, so that events long after the opening tell theirs; 0 stays unknown.
std::uint32_t RegisterServer::at_zero_of_clock(std::uint32_t unix_time_s) const {
  return unix_time_s == 0 ? 0 : unix_time_s - static_cast<std::uint32_t>(unit_->clock().ms / 1000);
}

void RegisterServer::open_session(const SessionOpen& host) {
  opened_ = {};
  if (host.protocol_version != kProtocolVersion) {
    opened_.error = UnitError::other_version;
    return;
  }
  HostSession& session = sessions_.open(host, origin_);
  session.host.unix_time_s = at_zero_of_clock(host.unix_time_s);
  opened_.session = session.id;
  asker_ = {opened_.session, host.challenge};
}

/// The session that the request has opened, as it is now.
SessionState RegisterServer::session_asked() {
  forget_hosts_of_another_start();
  SessionState state = std::exchange(asked_, Block{}) == kSessionOpen ? opened_ : SessionState{};
  const std::uint64_t now_ms = unit_->clock().ms;
  const HostSession* session = sessions_.find(state.session);
  if (session == nullptr) state.session = 0;
  if (session != nullptr) {
    state.sequence = session->result.sequence;
    state.window = session->window;
    state.nonce = session->nonce;
    state.armed_s = arming_.left_s(*session, now_ms);
  }
  state.wait_s = arming_.wait_s(origin_, now_ms);
  state.needs_code = arming_.needs_code();
  state.clock_ms = static_cast<std::uint32_t>(now_ms);
  state.stops = stops_;
  return state;
}

/// Why a window is not even looked at.
UnitError RegisterServer::refusal_of(const WindowOpen& window, const HostSession* session,
                                     std::span<const std::uint16_t> whole) {
  if (session == nullptr) return UnitError::session_unknown;
  const auto key = arming_.key_of(*session, unit_->clock().ms);
  if (!key) return UnitError::not_armed;
  if (!seal_agrees(whole, Keyed::window, key)) return UnitError::wrong_key;
  if (window.number > session->window) return UnitError::none;
  const bool again = window.number == window_.window().number && window.asker.session == window_.session();
  return again ? UnitError::none : UnitError::token_expired;
}

/// A window that is refused for its host leaves that of another one open.
void RegisterServer::open_window(const WindowOpen& window, std::span<const std::uint16_t> whole) {
  HostSession* session = sessions_.find(window.asker.session);
  UnitError error = refusal_of(window, session, whole);
  refused_window_.reset();
  if (error != UnitError::none) {
    refused_window_ = WindowAck{window.number, error, window.address, window.length, 0, 0};
  } else {
    session->window = window.number;
    session->proved = true;
    window_connection_ = connection_;
    if (!window_.open(window)) return;
    error = window_.error();
  }
  if (session == nullptr) return;
  if (in_axis_memory(window.address) && error == UnitError::none) return;  // the commit is what counts there
  note_window(*session, window, error);
}

void RegisterServer::note_window(const HostSession& session, const WindowOpen& window, UnitError error) {
  HostEvent written;
  written.state = error == UnitError::none ? CommandState::done : CommandState::refused;
  written.error = error;
  written.text = stretch_in_words(window.address, window.length);
  const bool armed = error != UnitError::not_armed && error != UnitError::wrong_key;
  note(session.host, unit_->clock().ms, std::move(written), armed);
}

std::uint32_t RegisterServer::note(const SessionOpen& host, std::uint64_t at_ms, HostEvent event, bool armed) {
  event.unit_time_s = static_cast<std::uint32_t>(at_ms / 1000);
  event.unix_time_s = host.unix_time_s == 0 ? 0 : host.unix_time_s + event.unit_time_s;
  event.starts = static_cast<std::uint16_t>(unit_->clock().starts);
  event.host = host.host;
  return events_.add(std::move(event), armed);
}

/// A host that falls silent loses what it was given; the list of events says when.
void RegisterServer::note_what_has_ended() {
  forget_hosts_of_another_start();
  for (HostSession& session : sessions_.all())
    session.keyed = session.proved && arming_.left_s(session, unit_->clock().ms) > 0;
  HostEvent ended;
  ended.error = UnitError::time_out;
  if (const auto at_ms = unit_->take_outputs_ended()) {
    ended.code = CommandCode::output_compensation;
    ended.state = CommandState::failed;
    ended.text = "relay opened";
    note(output_host_, *at_ms, ended, true);
  }
  while (const auto arming = arming_.take_ended(unit_->clock().ms)) {
    ended.code = CommandCode::arm;
    ended.state = CommandState::done;
    ended.text = "has ended";
    note(arming->host, arming->at_ms, ended, true);
  }
}

/// A command that comes again, or after a later one of its session, does nothing. In the session of an armed host its
/// key seals every command, but for one that switches off: that is carried out whoever gives it, also in no session
/// (0), whatever a stranger has given in the session of a host without a key, and leaves no trace in a session.
void RegisterServer::take_command(const Command& command, std::span<const std::uint16_t> whole) {
  selected_ = {command.asker, command.sequence};
  free_result_.reset();
  look_at_busy_command();
  HostSession nobody;
  HostSession* session = sessions_.find(command.asker.session);
  if (session == nullptr && !(command.asker.session == 0 && switches_off(command.code))) return;
  if (session == nullptr) session = &nobody;
  // Outside of a session the host key is 0, which an armed host may have as well.
  const auto key = session == &nobody ? std::nullopt : arming_.key_of(*session, unit_->clock().ms);
  const bool sealed = seal_agrees(whole, Keyed::command, key);
  const bool free =
      switches_off(command.code) && (key ? !sealed && seal_agrees(whole, Keyed::command, std::nullopt) : sealed);
  if (!free && command.sequence <= session->result.sequence) return;
  CommandResult result = sealed || free ? outcome_of(command, *session) : refused(UnitError::wrong_key);
  result.session = command.asker.session;
  result.sequence = command.sequence;
  if (result.state == CommandState::done && switches_off(command.code)) ++stops_;
  if (result.state == CommandState::done && command.relay_on) output_host_ = session->host;
  // A table that is gathered changes nothing yet: what replaces it is noted, and what the unit refuses.
  const bool gathers = command.code == CommandCode::begin_tools || command.code == CommandCode::stage_tool;
  const bool notable = needs_arming(command.code) && !(gathers && result.state == CommandState::done);
  if (!sealed || notable || switches_off(command.code) || command.code == CommandCode::arm) {
    HostEvent event;
    event.code = static_cast<std::uint16_t>(command.code) < kCommandCount ? command.code : CommandCode::none;
    event.state = result.state;
    event.error = result.error;
    event.text = arguments_in_words(command);
    const std::uint32_t number = note(session->host, unit_->clock().ms, std::move(event), key && sealed);
    if (result.state == CommandState::busy) busy_event_ = number;
  }
  if (free && !key && session != &nobody) note_speaker(session->id);
  if (free || !sealed) {
    free_result_ = std::move(result);
    return;
  }
  session->proved = session->proved || key;
  note_speaker(session->id);
  session->result = std::move(result);
}

/// Why a command is not even looked at by the unit.
UnitError RegisterServer::refusal_of(const Command& command, const HostSession& session) {
  if (command.code == CommandCode::none) return UnitError::bad_argument;
  if (static_cast<std::uint16_t>(command.code) >= kCommandCount) return UnitError::unknown_command;
  if (port_busy_ && !switches_off(command.code)) return UnitError::busy;
  const std::uint64_t now_ms = unit_->clock().ms;
  if (needs_arming(command.code) && arming_.left_s(session, now_ms) == 0) return UnitError::not_armed;
  if (!acts_at_once(command.code)) return UnitError::none;
  const std::uint32_t age_ms = static_cast<std::uint32_t>(now_ms) - command.clock_ms;
  if (age_ms > kMostAge_ms) return UnitError::late;
  return command.stops == stops_ ? UnitError::none : UnitError::overtaken;
}

void RegisterServer::begin_arming(const ArmShare& arm) {
  HostSession* session = sessions_.find(arm.session);
  arming_answer_ = {};
  arming_answer_.error = UnitError::session_unknown;
  if (session == nullptr) return;
  arming_answer_ = arming_.begin(arm, *session, unit_->identity().serial_number, origin_, unit_->clock().ms);
  if (arming_answer_.error != UnitError::none) note_arming(*session, arming_answer_.error, 0);
}

/// A host that is armed is present: the unit that is starting enters integration mode.
void RegisterServer::confirm_arming(const ArmConfirm& arm) {
  HostSession* session = sessions_.find(arm.session);
  arming_answer_ = {};
  arming_answer_.error = UnitError::session_unknown;
  if (session == nullptr) return;
  const bool tries = session->exchange.has_value();
  arming_answer_ = arming_.confirm(arm, *session, origin_, unit_->clock().ms);
  if (const auto code = arming_.take_new_code()) unit_->show_code(*code);
  if (!tries) return;
  note_arming(*session, arming_answer_.error, arming_answer_.armed_s);
  if (arming_answer_.armed_s == 0) return;
  if (!session->proved) session->result = {};  // whoever knows the session may have given commands in it
  session->proved = true;
  note_speaker(session->id);
  unit_->host_armed();
}

void RegisterServer::note_arming(const HostSession& session, UnitError error, std::uint32_t seconds) {
  HostEvent event;
  event.code = CommandCode::arm;
  event.error = error;
  event.state = error == UnitError::none ? CommandState::done : CommandState::refused;
  if (error == UnitError::none) event.text = minutes_in_words(seconds);
  note(session.host, unit_->clock().ms, std::move(event), error == UnitError::none);
}

CommandResult RegisterServer::outcome_of(const Command& command, const HostSession& session) {
  if (command.code == CommandCode::arm) {
    arming_.disarm(session);
    return {0, CommandState::done, UnitError::none, 0, 0, {}};
  }
  if (command.code == CommandCode::check_memory) return check_memory(command);
  if (const UnitError error = refusal_of(command, session); error != UnitError::none) return refused(error);
  // What switches off does not wait for a command under way: it ends it first.
  if (port_busy_ && switches_off(command.code)) {
    static_cast<void>(unit_->begin({.code = CommandCode::stop}));
    look_at_busy_command();
    if (command.code == CommandCode::stop) return {0, CommandState::done, UnitError::none, 0, 0, {}};
  }
  CommandResult result = begun(command);
  if (result.state == CommandState::busy) {
    port_busy_ = true;
    busy_ = {command.asker, command.sequence};
  }
  return result;
}

/// The unit's answer. A staging ends with the next one, with its commit and when it is abandoned; under another token
/// than its own it does neither.
CommandResult RegisterServer::begun(const Command& command) {
  const bool begins = command.code == CommandCode::begin_staging;
  const bool ends = command.code == CommandCode::commit_staged || command.code == CommandCode::abandon_staged;
  if (ends && window_.token() == 0) return refused(UnitError::no_staging);
  if (ends && command.token != window_.token()) return refused(UnitError::token_expired);
  CommandResult result = unit_->begin(command);
  if (result.state != CommandState::done && result.state != CommandState::busy) return result;
  if (begins) result.token = number_by_chance(window_.token());
  if (begins || ends) window_.stage_under(result.token);
  return result;
}

CommandResult RegisterServer::check_memory(const Command& command) {
  CommandResult result{0, CommandState::done, UnitError::none, 0, 0, {}};
  std::vector<std::uint8_t> bytes(std::min(command.length, kLongestCheck));
  if (command.length == 0 || command.length > kLongestCheck)
    result.error = UnitError::bad_argument;
  else
    result.error = unit_->read_memory(command.address, bytes);
  if (result.error != UnitError::none)
    result.state = CommandState::refused;
  else
    result.value = crc32_of(bytes);
  return result;
}

/// Takes over how far the command under way is, or how it has ended.
void RegisterServer::look_at_busy_command() {
  if (!port_busy_) return;
  CommandResult now = unit_->progress();
  port_busy_ = now.state == CommandState::busy;
  events_.settle(busy_event_, now.state, now.error);
  HostSession* session = sessions_.find(busy_.asker.session);
  if (session == nullptr || session->result.sequence != busy_.sequence) return;
  now.session = busy_.asker.session;
  now.sequence = busy_.sequence;
  session->result = std::move(now);
}

/// Idle: that command is not the newest of its session.
CommandResult RegisterServer::result_selected() {
  forget_hosts_of_another_start();
  look_at_busy_command();
  const Block asked = std::exchange(asked_, Block{});
  if (asked != kCommand && asked != kResultSelect) return {};
  CommandResult result;
  if (const HostSession* session = sessions_.find(selected_.asker.session); asked == kCommand && free_result_)
    result = *free_result_;
  else if (session == nullptr)
    result = refused(UnitError::session_unknown);
  else if (session->result.sequence == selected_.sequence)
    result = session->result;
  result.session = selected_.asker.session;
  result.sequence = selected_.sequence;
  return result;
}

namespace {

/// The same stretch, whoever asks again.
bool same_window(WindowOpen a, const WindowOpen& b) {
  a.asker.challenge = b.asker.challenge;
  return a == b;
}

/// @param count  0 … 64
std::uint64_t bits_below(std::size_t count) {
  return count >= kWindowBlocks ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

}  // namespace

bool MemoryWindow::open(const WindowOpen& window) {
  if (same_window(window, window_)) return false;
  window_ = window;
  received_ = 0;
  const bool possible = window.length > 0 && window.length <= kWindowBlocks * window.block_bytes();
  if (window.number == 0 || !possible || (window.coded && !in_axis_memory(window.address)))
    error_ = UnitError::bad_argument;
  else if (in_axis_memory(window.address) && (window.token == 0 || window.token != token_))
    error_ = UnitError::token_expired;
  else
    error_ = unit_->may_write(window.address, window.length);
  return true;
}

void MemoryWindow::refuse(UnitError why) {
  received_ = 0;
  error_ = why;
}

void MemoryWindow::stage_under(std::uint32_t token) {
  token_ = token;
  received_ = 0;
  error_ = UnitError::token_expired;
}

bool MemoryWindow::take(std::span<const std::uint16_t> registers, const std::optional<Secret>& key) {
  if (error_ != UnitError::none || registers.size() < kBlockHeaderRegisters) return false;
  const std::uint16_t tag = registers[0];
  const std::uint16_t number = registers[1];
  const auto payload = registers.subspan(kBlockHeaderRegisters);
  if (window_.number == 0 || tag != window_.tag()) return false;
  const std::size_t bytes = window_.coded ? 2 * payload.size() : bytes_in_block(window_.length, number);
  if (bytes == 0 || payload.size() != (bytes + 1) / 2) return false;
  const auto content = unpacked(payload, bytes);
  if (!key || block_check(key, window_, number, content) != check_at_end(registers.first(kBlockHeaderRegisters))) {
    refuse(UnitError::check_mismatch);
    return false;
  }
  if (window_.coded) return take_coded(number, content);
  if (!put(number * kBlockBytes, content)) return false;
  received_ |= std::uint64_t{1} << number;
  return true;
}

bool MemoryWindow::put(std::size_t offset, std::span<const std::uint8_t> bytes) {
  error_ = unit_->write_memory(static_cast<Address>(window_.address + offset), bytes);
  return error_ == UnitError::none;
}

/// The codes of as many blocks as the high byte of `number` says, and one more, from the block of its low byte on.
bool MemoryWindow::take_coded(std::uint16_t number, std::span<const std::uint8_t> code) {
  const std::size_t first = number & 0xFFu;
  const std::size_t count = (number >> 8) + std::size_t{1};
  const std::size_t blocks = blocks_in(window_.length, kCodedBlockBytes);
  if (count > kCodedBlocksInFrame || first >= blocks || count > blocks - first) return false;
  if ((~received_ & bits_below(first)) != 0) return false;
  const std::size_t offset = first * kCodedBlockBytes;
  const std::size_t bytes = std::min(count * kCodedBlockBytes, window_.length - offset);
  const Address at = static_cast<Address>(window_.address + offset);
  const Address bank = kBankB.contains(at) ? kBankB.first : kBankA.first;
  const std::size_t history = std::min<std::size_t>(at - bank, block_code::kHistoryBytes);
  const auto memory = std::span(decoded_).first(history + bytes);
  if (unit_->read_memory(static_cast<Address>(at - history), memory.first(history)) != UnitError::none) return false;
  if (!decode_blocks(code, memory, history, kCodedBlockBytes) || !put(offset, memory.subspan(history))) return false;
  received_ |= bits_below(first + count) & ~bits_below(first);
  return true;
}

std::uint64_t MemoryWindow::all_blocks() const { return bits_below(blocks_in(window_.length, window_.block_bytes())); }

WindowAck MemoryWindow::ack() const {
  WindowAck ack{window_.number, error_, window_.address, window_.length, received_, 0};
  if (window_.number == 0 || error_ != UnitError::none || received_ != all_blocks()) return ack;
  std::vector<std::uint8_t> held(window_.length);
  ack.error = unit_->read_memory(window_.address, held);
  if (ack.error == UnitError::none) ack.crc = crc32_of(held);
  return ack;
}

}  // namespace ecs::protocol
