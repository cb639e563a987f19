// The order of the fields in every block, once for both directions.
#include "protocol/registers/unit_registers.hpp"

#include <algorithm>

#include "protocol/registers/field_pass.hpp"

namespace ecs::protocol {

namespace {

template <class Pass, class T>
void fields(Pass& pass, T& identity) requires std::is_same_v<std::remove_const_t<T>, Identity> {
  pass.number(identity.protocol_version, "protocol version");
  pass.number(identity.firmware_major, "firmware version");
  pass.number(identity.firmware_minor, "firmware version");
  pass.text(identity.serial_number, kSerialNumberBytes, "serial number");
  pass.text(identity.unit_name, kUnitNameBytes, "unit name");
  pass.number(identity.memory_modules, "memory modules");
  pass.axes(identity.axis_present);
  pass.number(identity.capacity_values, "capacity");
  pass.text(identity.machine, kMachineBytes, "machine");
  pass.number(identity.configuration, "configuration");
}

/// The faulty axis travels as 0 none, 1 X, 2 Y, 3 Z.
void fault_axis(FieldWriter& pass, const std::optional<Axis>& axis) {
  pass.number(static_cast<std::uint16_t>(axis ? index_of(*axis) + 1 : 0), "fault axis");
}
void fault_axis(FieldReader& pass, std::optional<Axis>& axis) {
  std::uint16_t word = 0;
  pass.one_of(word, kAxes + 1, "fault axis");
  axis = word == 0 ? std::nullopt : std::optional(static_cast<Axis>(word - 1));
}

template <class Pass, class T>
void axis_fields(Pass& pass, T& axis) {
  pass.flag(axis.referenced, "referenced");
  pass.one_of(axis.datum_stage, kDatumStageCount, "datum stage");
  pass.one_of(axis.datum_failure, kDatumFailureCount, "datum failure");
  pass.real(axis.position_mm, "position");
  pass.approach(axis.last_approach);
  pass.flag(axis.relay_closed, "relay");
}

template <class Pass, class T>
void fields(Pass& pass, T& status) requires std::is_same_v<std::remove_const_t<T>, UnitStatus> {
  pass.one_of(status.mode, 5, "mode");
  pass.one_of(status.fault, kFaultCount, "fault");
  pass.number(status.fault_address, "fault address");
  fault_axis(pass, status.fault_axis);
  pass.one_of(status.ram_test, 3, "RAM test");
  pass.number(status.ram_test_address, "RAM test address");
  pass.number(status.block_check_expected, "block check");
  pass.number(status.block_check_found, "block check");
  pass.one_of(status.active_bank, 3, "active bank");
  pass.number(status.commit_sequence, "commit sequence");
  pass.number(status.image_length_bytes, "image length");
  pass.real(status.loop_period_us, "loop period");
  pass.number(status.loop_overruns, "loop overruns");
  pass.number(status.ticks, "ticks");
  pass.number(status.uptime_s, "uptime");
  pass.number(status.watchdog_trips, "watchdog trips");
  for (auto& axis : status.axes) axis_fields(pass, axis);
}

template <class Pass, class T>
void pointer_fields(Pass& pass, T& status) {
  pass.number(status.pointers_at_tick, "pointers");
  for (auto& pointer : status.pointers) {
    pass.number(pointer.index, "pointer");
    pass.number(pointer.address, "pointer");
  }
}

template <class Pass, class T>
void fields(Pass& pass, T& map) requires std::is_same_v<std::remove_const_t<T>, ActiveMap> {
  pass.text(map.serial_number, kSerialNumberBytes, "serial number");
  pass.number(map.block_check_expected, "block check");
  pass.number(map.block_check_found, "block check");
  pass.one_of(map.active_bank, 3, "active bank");
  pass.number(map.commit_sequence, "commit sequence");
  pass.number(map.image_length_bytes, "image length");
}

template <class Pass, class T>
void sample_fields(Pass& pass, T& axis, Axis which) {
  pass.letter(axis.present, which);
  pass.real(axis.position_mm, "position");
  pass.real(axis.speed_mm_min, "speed");
  pass.flag(axis.referenced, "referenced");
  pass.flag(axis.switch_active, "switch");
  pass.flag(axis.marker, "marker");
  pass.approach(axis.approach);
  pass.real(axis.compensation_um, "compensation");
  pass.number(axis.output_counts, "output");
  pass.flag(axis.relay_closed, "relay");
}

template <class Pass, class T>
void fields(Pass& pass, T& sample) requires std::is_same_v<std::remove_const_t<T>, MonitorSample> {
  pass.number(sample.number, "sample number");
  pass.number(sample.unit_time_us, "unit time");
  pass.one_of(sample.mode, 5, "mode");
  pass.one_of(sample.fault, kFaultCount, "fault");
  for (const Axis a : kAllAxes) sample_fields(pass, sample.axes[index_of(a)], a);
}

template <class Pass, class T>
void arguments(Pass& pass, T& command) {
  switch (command.code) {
    case CommandCode::set_axis_position:
      pass.one_of(command.axis, kAxes, "axis");
      return pass.real(command.position_mm, "position");
    case CommandCode::output_compensation:
      pass.one_of(command.axis, kAxes, "axis");
      pass.real(command.output_um, "output");
      return pass.flag(command.relay_on, "relay");
    case CommandCode::begin_staging:
      return pass.one_of(command.staging_from, 3, "staging from");
    case CommandCode::commit_staged:
      pass.number(command.length, "length");
      pass.number(command.crc, "CRC");
      return pass.number(command.token, "token");
    case CommandCode::abandon_staged:
      return pass.number(command.token, "token");
    case CommandCode::test_datum:
    case CommandCode::record_datum:
      return pass.one_of(command.axis, kAxes, "axis");
    case CommandCode::run_user_software:
      pass.number(command.address, "address");
      return pass.number(command.argument, "argument");
    case CommandCode::check_memory:
      pass.number(command.address, "address");
      return pass.number(command.length, "length");
    case CommandCode::arm:
      pass.number(command.minutes, "minutes");
      return pass.number(command.proof, "proof");
    default:
      return;
  }
}

template <class Pass, class T>
void fields(Pass& pass, T& command) requires std::is_same_v<std::remove_const_t<T>, Command> {
  pass.number(command.session, "session");
  pass.number(command.sequence, "sequence");
  pass.one_of(command.code, kCommandCount, "command");
  pass.number(command.clock_ms, "clock");
  pass.number(command.stops, "stops");
  arguments(pass, command);
  pass.rest(kCommand.count - kCheckRegisters);
  pass.check();
}

template <class Pass, class T>
void fields(Pass& pass, T& result) requires std::is_same_v<std::remove_const_t<T>, CommandResult> {
  pass.number(result.session, "session");
  pass.number(result.sequence, "sequence");
  pass.one_of(result.state, 5, "command state");
  pass.one_of(result.error, kUnitErrorCount, "error");
  pass.number(result.per_mille, "progress");
  pass.number(result.value, "value");
  pass.number(result.token, "token");
  pass.text(result.text, kResultTextBytes, "text");
}

template <class Pass, class T>
void fields(Pass& pass, T& window) requires std::is_same_v<std::remove_const_t<T>, WindowOpen> {
  pass.number(window.tag, "tag");
  pass.number(window.address, "address");
  pass.number(window.length, "length");
  pass.number(window.token, "token");
  pass.flag(window.coded, "coded");
  pass.number(window.session, "session");
  pass.check();
}

template <class Pass, class T>
void fields(Pass& pass, T& select) requires std::is_same_v<std::remove_const_t<T>, CheckSelect> {
  pass.number(select.address, "address");
  pass.number(select.length, "length");
  pass.number(select.piece, "piece");
}

template <class Pass, class T>
void fields(Pass& pass, T& ack) requires std::is_same_v<std::remove_const_t<T>, WindowAck> {
  pass.number(ack.tag, "tag");
  pass.one_of(ack.error, kUnitErrorCount, "error");
  pass.number(ack.address, "address");
  pass.number(ack.length, "length");
  pass.number(ack.received, "received");
  pass.number(ack.crc, "CRC");
}

template <class Pass, class T>
void fields(Pass& pass, T& select) requires std::is_same_v<std::remove_const_t<T>, ReadSelect> {
  pass.number(select.address, "address");
  pass.number(select.bytes, "bytes");
}

template <class Pass, class T>
void fields(Pass& pass, T& select) requires std::is_same_v<std::remove_const_t<T>, ResultSelect> {
  pass.number(select.session, "session");
  pass.number(select.sequence, "sequence");
}

template <class Pass, class T>
void fields(Pass& pass, T& open) requires std::is_same_v<std::remove_const_t<T>, SessionOpen> {
  pass.number(open.protocol_version, "protocol version");
  pass.number(open.key, "key");
  pass.number(open.number, "number");
  pass.number(open.unix_time_s, "time");
  pass.text(open.host, kHostNameBytes, "host");
  pass.check();
}

template <class Pass, class T>
void fields(Pass& pass, T& state) requires std::is_same_v<std::remove_const_t<T>, SessionState> {
  pass.number(state.protocol_version, "protocol version");
  pass.one_of(state.error, kUnitErrorCount, "error");
  pass.number(state.session, "session");
  pass.number(state.sequence, "sequence");
  pass.number(state.clock_ms, "clock");
  pass.number(state.stops, "stops");
  pass.number(state.armed_s, "armed");
  pass.number(state.wait_s, "wait");
}

template <class Pass, class T>
void fields(Pass& pass, T& page) requires std::is_same_v<std::remove_const_t<T>, EventPage> {
  pass.number(page.newest, "newest event");
  for (auto& event : page.events) {
    pass.number(event.number, "event");
    pass.number(event.unit_time_s, "unit time");
    pass.number(event.unix_time_s, "time");
    pass.number(event.starts, "starts");
    pass.number(event.times, "times");
    pass.one_of(event.code, kCommandCount, "command");
    pass.one_of(event.error, kUnitErrorCount, "error");
    pass.one_of(event.state, 5, "command state");
    pass.text(event.host, kHostNameBytes, "host");
    pass.text(event.text, kEventTextBytes, "text");
  }
}

template <class Pass, class T>
void fields(Pass& pass, T& select) requires std::is_same_v<std::remove_const_t<T>, EventSelect> {
  pass.number(select.first, "event");
}

template <class T>
Registers with_echo(const T& value, std::uint16_t echo) {
  FieldWriter pass;
  pass.number(echo, "echo");
  fields(pass, value);
  return std::move(pass.out_);
}

Result<void> verdict(const FieldReader& pass, std::string_view what) {
  if (pass.problem_.empty()) return {};
  return problem(ProblemKind::link,
                 fmt::format("{} from the unit makes no sense: {}; host and unit may be of different versions", what,
                             pass.problem_));
}

template <class T>
Result<T> from(std::span<const std::uint16_t> block, std::string_view what) {
  FieldReader pass(block);
  std::uint16_t echo = 0;
  pass.number(echo, "echo");
  T value;
  fields(pass, value);
  return verdict(pass, what).map([&] { return value; });
}

}  // namespace

Registers registers_of(const Identity& identity, std::uint16_t echo) { return with_echo(identity, echo); }
Registers registers_of(const UnitStatus& status, std::uint16_t echo) { return with_echo(status, echo); }
Registers registers_of(const ActiveMap& map, std::uint16_t echo) { return with_echo(map, echo); }
Registers registers_of(const MonitorSample& sample, std::uint16_t echo) { return with_echo(sample, echo); }
Registers registers_of(const CommandResult& result, std::uint16_t echo) { return with_echo(result, echo); }
Registers registers_of(const WindowAck& ack, std::uint16_t echo) { return with_echo(ack, echo); }
Registers registers_of(const Command& command, std::uint16_t echo) { return with_echo(command, echo); }
Registers registers_of(const WindowOpen& window, std::uint16_t echo) { return with_echo(window, echo); }
Registers registers_of(const CheckSelect& select, std::uint16_t echo) { return with_echo(select, echo); }
Registers registers_of(const ReadSelect& select, std::uint16_t echo) { return with_echo(select, echo); }
Registers registers_of(const ResultSelect& select, std::uint16_t echo) { return with_echo(select, echo); }
Registers registers_of(const SessionOpen& open, std::uint16_t echo) { return with_echo(open, echo); }
Registers registers_of(const SessionState& state, std::uint16_t echo) { return with_echo(state, echo); }
Registers registers_of(const EventPage& page, std::uint16_t echo) { return with_echo(page, echo); }
Registers registers_of(const EventSelect& select, std::uint16_t echo) { return with_echo(select, echo); }

Registers pointer_registers_of(const UnitStatus& status, std::uint16_t echo) {
  FieldWriter pass;
  pass.number(echo, "echo");
  pointer_fields(pass, status);
  return std::move(pass.out_);
}

Result<Identity> identity_in(std::span<const std::uint16_t> block) { return from<Identity>(block, "the identity"); }
Result<UnitStatus> status_in(std::span<const std::uint16_t> block) { return from<UnitStatus>(block, "the status"); }
Result<ActiveMap> active_map_in(std::span<const std::uint16_t> block) {
  return from<ActiveMap>(block, "the active map");
}
Result<MonitorSample> monitor_in(std::span<const std::uint16_t> block) {
  return from<MonitorSample>(block, "the monitor sample");
}
Result<CommandResult> command_result_in(std::span<const std::uint16_t> block) {
  return from<CommandResult>(block, "the command result");
}
Result<WindowAck> window_ack_in(std::span<const std::uint16_t> block) {
  return from<WindowAck>(block, "the acknowledgement");
}
Result<Command> command_in(std::span<const std::uint16_t> block) { return from<Command>(block, "the command"); }
Result<WindowOpen> window_open_in(std::span<const std::uint16_t> block) {
  return from<WindowOpen>(block, "the window");
}
Result<CheckSelect> check_select_in(std::span<const std::uint16_t> block) {
  return from<CheckSelect>(block, "the selection");
}
Result<ReadSelect> read_select_in(std::span<const std::uint16_t> block) {
  return from<ReadSelect>(block, "the selection");
}
Result<ResultSelect> result_select_in(std::span<const std::uint16_t> block) {
  return from<ResultSelect>(block, "the selection");
}
Result<SessionOpen> session_open_in(std::span<const std::uint16_t> block) {
  return from<SessionOpen>(block, "the session");
}
Result<SessionState> session_state_in(std::span<const std::uint16_t> block) {
  return from<SessionState>(block, "the session");
}

Result<EventSelect> event_select_in(std::span<const std::uint16_t> block) {
  return from<EventSelect>(block, "the selection");
}
Result<EventPage> event_page_in(std::span<const std::uint16_t> block) {
  return from<EventPage>(block, "the list of events");
}

bool check_agrees(std::span<const std::uint16_t> block) {
  FieldWriter pass;
  pass.out_.assign(block.begin(), block.end() - kCheckRegisters);
  pass.check();
  return std::equal(block.begin(), block.end(), pass.out_.begin(), pass.out_.end());
}

Result<void> take_pointers(std::span<const std::uint16_t> block, UnitStatus& status) {
  FieldReader pass(block);
  std::uint16_t echo = 0;
  pass.number(echo, "echo");
  pointer_fields(pass, status);
  return verdict(pass, "the pointers");
}

Registers packed(std::span<const std::uint8_t> bytes) {
  Registers registers((bytes.size() + 1) / 2, 0);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const unsigned shift = i % 2 == 0 ? 8 : 0;
    registers[i / 2] = static_cast<std::uint16_t>(registers[i / 2] | bytes[i] << shift);
  }
  return registers;
}

std::vector<std::uint8_t> unpacked(std::span<const std::uint16_t> registers, std::size_t bytes) {
  std::vector<std::uint8_t> out(bytes);
  for (std::size_t i = 0; i < bytes; ++i)
    out[i] = static_cast<std::uint8_t>(i % 2 == 0 ? registers[i / 2] >> 8 : registers[i / 2] & 0xFF);
  return out;
}

}  // namespace ecs::protocol
