// The order of the fields in every block, once for both directions.
#include "protocol/registers/unit_registers.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/axis.hpp"
#include "protocol/registers/fields.hpp"

namespace ecs::protocol {

namespace {

/// Read or written: a list of fields runs through either pass.
template <class T, class Of>
concept Is = std::is_same_v<std::remove_const_t<T>, Of>;

template <class Pass, Is<Asker> T>
void fields(Pass& pass, T& asker) {
  pass.number(asker.session, "session");
  pass.number(asker.challenge, "challenge");
}

template <class Pass, Is<EchoAsk> T>
void fields(Pass& pass, T& ask) {
  fields(pass, ask.asker);
}

template <class Pass, Is<ArmShare> T>
void fields(Pass& pass, T& arm) {
  pass.number(arm.session, "session");
  pass.number(arm.minutes, "minutes");
  pass.octets(arm.share);
  pass.check();
}

template <class Pass, Is<ArmConfirm> T>
void fields(Pass& pass, T& arm) {
  pass.number(arm.session, "session");
  pass.octets(arm.confirmation);
  pass.check();
}

template <class Pass, Is<ArmAnswer> T>
void fields(Pass& pass, T& answer) {
  pass.one_of(answer.error, kUnitErrorCount, "error");
  pass.number(answer.wait_s, "wait");
  pass.octets(answer.share);
  pass.octets(answer.confirmation);
  pass.number(answer.armed_s, "armed");
}

template <class Pass, Is<Identity> T>
void fields(Pass& pass, T& identity) {
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

template <class Pass, Is<UnitStatus> T>
void fields(Pass& pass, T& status) {
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

template <class Pass, Is<ActiveMap> T>
void fields(Pass& pass, T& map) {
  pass.text(map.serial_number, kSerialNumberBytes, "serial number");
  pass.number(map.block_check_expected, "block check");
  pass.number(map.block_check_found, "block check");
  pass.one_of(map.active_bank, 3, "active bank");
  pass.number(map.commit_sequence, "commit sequence");
  pass.number(map.image_length_bytes, "image length");
  pass.octets(map.digest);
  pass.keyed();
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

template <class Pass, Is<MonitorSample> T>
void fields(Pass& pass, T& sample) {
  pass.number(sample.number, "sample number");
  pass.number(sample.unit_time_us, "unit time");
  pass.one_of(sample.mode, 5, "mode");
  pass.one_of(sample.fault, kFaultCount, "fault");
  for (const Axis a : kAllAxes) sample_fields(pass, sample.axes[index_of(a)], a);
}

template <class Pass, class T>
void input_fields(Pass& pass, T& input) {
  pass.one_of(input.state, kInputStateCount, "input state");
  pass.real(input.value, "input");
  pass.number(input.faults, "input faults");
}

/// The wired inputs travel as one mask.
template <class Pass, Is<LiveInputs> T>
void fields(Pass& pass, T& live) {
  std::uint32_t wired = 0;
  for (std::size_t i = 0; i < kInputsInBlock; ++i) wired |= live.inputs[i].wired ? 1u << i : 0u;
  pass.number(live.stored_age_s, "age of the stored state");
  pass.number(live.rows, "thermal rows");
  for (auto& um : live.thermal_um) pass.real(um, "thermal compensation");
  pass.number(wired, "wired inputs");
  for (std::size_t i = 0; i < kInputsInBlock; ++i) {
    auto& input = live.inputs[i];
    input_fields(pass, input);
    if constexpr (!std::is_const_v<T>) input.wired = (wired >> i & 1) != 0;
  }
}

/// Wires and outputs travel as one mask, the first as its lowest bit.
template <class Pass, Is<ControlLines> T>
void fields(Pass& pass, T& lines) {
  std::uint16_t mask = 0;
  unsigned bit = 0;
  for (const bool one : {lines.tool_wired, lines.control_on_wired, lines.control_on, lines.compensating_out,
                         lines.fault_out, lines.deviation.wired})
    mask = static_cast<std::uint16_t>(mask | static_cast<unsigned>(one) << bit++);
  pass.number(lines.tool, "tool");
  pass.one_of(lines.tool_state, kToolStateCount, "state of the tool");
  for (auto& mm : lines.tool_offset_mm) pass.real(mm, "tool offset");
  for (auto& um_per_m : lines.squareness_um_per_m) pass.real(um_per_m, "squareness");
  pass.number(lines.tools, "tools");
  pass.number(mask, "wires");
  pass.one_of(lines.battery, 2, "battery");
  pass.number(lines.battery_age_s, "age of the battery");
  input_fields(pass, lines.deviation);
  if constexpr (!std::is_const_v<T>) {
    bit = 0;
    for (bool* one : {&lines.tool_wired, &lines.control_on_wired, &lines.control_on, &lines.compensating_out,
                      &lines.fault_out, &lines.deviation.wired})
      *one = (static_cast<unsigned>(mask) >> bit++ & 1u) != 0;
  }
}

template <class Pass, Is<RotarySample> T>
void fields(Pass& pass, T& sample) {
  for (auto& um : sample.compensation_um) pass.real(um, "compensation of the rotary axes");
  for (auto& axis : sample.axes) {
    pass.rotary_letter(axis.letter);
    pass.flag(axis.sensed, "transducer");
    pass.real(axis.angle_deg, "angle");
    pass.approach(axis.approach);
  }
}

/// Three values that travel as whole steps.
void in_steps(FieldWriter& pass, const Vector3& values, double step, std::string_view name) {
  constexpr double kMost = 2e9;  // what is no number is beyond every range, too
  for (const double value : values) {
    const double steps = std::isnan(value) ? kMost : std::clamp(value / step, -kMost, kMost);
    pass.number(static_cast<std::int32_t>(std::lround(steps)), name);
  }
}
void in_steps(FieldReader& pass, Vector3& values, double step, std::string_view name) {
  for (double& value : values) {
    std::int32_t steps = 0;
    pass.number(steps, name);
    value = steps * step;
  }
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
    case CommandCode::set_input:
      pass.one_of(command.input, kLiveInputs, "input");
      return pass.real(command.input_value, "input");
    case CommandCode::select_tool:
    case CommandCode::remove_tool:
      return pass.number(command.tool, "tool");
    case CommandCode::set_tool:
    case CommandCode::stage_tool:
      pass.number(command.tool, "tool");
      return in_steps(pass, command.tool_offset_mm, kToolStep_mm, "tool offset");
    case CommandCode::try_squareness:
      return in_steps(pass, command.squareness_um_per_m, kSquarenessStep_um_per_m, "squareness");
    case CommandCode::begin_staging:
      return pass.one_of(command.staging_from, 3, "staging from");
    case CommandCode::commit_staged:
      pass.number(command.length, "length");
      pass.number(command.digest, "digest");
      return pass.number(command.token, "token");
    case CommandCode::commit_tools:
      pass.number(command.length, "number of tools");
      return pass.number(command.digest, "digest");
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
    default:
      return;
  }
}

template <class Pass, Is<Command> T>
void fields(Pass& pass, T& command) {
  fields(pass, command.asker);
  pass.number(command.sequence, "sequence");
  pass.one_of(command.code, kCommandCount, "command");
  pass.number(command.clock_ms, "clock");
  pass.number(command.stops, "stops");
  arguments(pass, command);
  pass.rest(kCommand.count - kKeyedCheckRegisters);
  pass.keyed();
}

template <class Pass, Is<CommandResult> T>
void fields(Pass& pass, T& result) {
  pass.number(result.session, "session");
  pass.number(result.sequence, "sequence");
  pass.one_of(result.state, 5, "command state");
  pass.one_of(result.error, kUnitErrorCount, "error");
  pass.number(result.per_mille, "progress");
  pass.number(result.value, "value");
  pass.number(result.token, "token");
  pass.text(result.text, kResultTextBytes, "text");
  pass.keyed();
}

template <class Pass, Is<WindowOpen> T>
void fields(Pass& pass, T& window) {
  fields(pass, window.asker);
  pass.number(window.number, "number");
  pass.number(window.address, "address");
  pass.number(window.length, "length");
  pass.number(window.token, "token");
  pass.flag(window.coded, "coded");
  pass.keyed();
}

template <class Pass, Is<MemoryHead> T>
void fields(Pass& pass, T& head) {
  pass.number(head.address, "address");
  pass.number(head.crc, "CRC");
}

template <class Pass, Is<CheckSelect> T>
void fields(Pass& pass, T& select) {
  fields(pass, select.asker);
  pass.number(select.address, "address");
  pass.number(select.length, "length");
  pass.number(select.piece, "piece");
}

template <class Pass, Is<WindowAck> T>
void fields(Pass& pass, T& ack) {
  pass.number(ack.number, "number");
  pass.one_of(ack.error, kUnitErrorCount, "error");
  pass.number(ack.address, "address");
  pass.number(ack.length, "length");
  pass.number(ack.received, "received");
  pass.number(ack.crc, "CRC");
  pass.keyed();
}

template <class Pass, Is<ReadSelect> T>
void fields(Pass& pass, T& select) {
  pass.number(select.address, "address");
  pass.number(select.bytes, "bytes");
  fields(pass, select.asker);
}

template <class Pass, Is<ResultSelect> T>
void fields(Pass& pass, T& select) {
  fields(pass, select.asker);
  pass.number(select.sequence, "sequence");
}

template <class Pass, Is<SessionOpen> T>
void fields(Pass& pass, T& open) {
  pass.number(open.challenge, "challenge");
  pass.number(open.protocol_version, "protocol version");
  pass.number(open.key, "key");
  pass.number(open.number, "number");
  pass.number(open.unix_time_s, "time");
  pass.text(open.host, kHostNameBytes, "host");
  pass.check();
}

template <class Pass, Is<SessionState> T>
void fields(Pass& pass, T& state) {
  pass.number(state.protocol_version, "protocol version");
  pass.one_of(state.error, kUnitErrorCount, "error");
  pass.number(state.session, "session");
  pass.number(state.sequence, "sequence");
  pass.number(state.window, "window");
  pass.number(state.clock_ms, "clock");
  pass.number(state.stops, "stops");
  pass.number(state.armed_s, "armed");
  pass.number(state.wait_s, "wait");
  pass.flag(state.needs_code, "needs a code");
  pass.number(state.nonce, "nonce");
  pass.keyed();
}

template <class Pass, Is<EventPage> T>
void fields(Pass& pass, T& page) {
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

template <class Pass, Is<EventSelect> T>
void fields(Pass& pass, T& select) {
  pass.number(select.first, "event");
}

Result<void> verdict(const FieldReader& pass, std::string_view what) {
  if (pass.problem_.empty()) return {};
  return problem(
      ProblemKind::link,
      fmt::format("{} from the unit is not valid: {}; host and unit may have different versions", what, pass.problem_));
}

}  // namespace

/// In words, for problems.
template <class T>
constexpr std::string_view kBlockName = "the selection";

template <class T>
Registers registers_of(const T& value, std::uint16_t echo) {
  FieldWriter pass;
  pass.number(echo, "echo");
  fields(pass, value);
  return std::move(pass.out_);
}

template <class T>
Result<T> value_in(std::span<const std::uint16_t> block) {
  FieldReader pass(block);
  std::uint16_t echo = 0;
  pass.number(echo, "echo");
  T value;
  fields(pass, value);
  return verdict(pass, kBlockName<T>).map([&] { return value; });
}

// Every block that travels with its echo.
#define ECS_BLOCK(Type, name)                                  \
  template <>                                                  \
  constexpr std::string_view kBlockName<Type> = name;          \
  template Registers registers_of(const Type&, std::uint16_t); \
  template Result<Type> value_in(std::span<const std::uint16_t>)
ECS_BLOCK(Identity, "the identity");
ECS_BLOCK(UnitStatus, "the status");
ECS_BLOCK(ActiveMap, "the active map");
ECS_BLOCK(MonitorSample, "the monitor sample");
ECS_BLOCK(LiveInputs, "the live inputs");
ECS_BLOCK(ControlLines, "the lines to the control");
ECS_BLOCK(RotarySample, "the sample of the rotary axes");
ECS_BLOCK(CommandResult, "the command result");
ECS_BLOCK(WindowAck, "the acknowledgement");
ECS_BLOCK(SessionState, "the session");
ECS_BLOCK(EventPage, "the list of events");
ECS_BLOCK(MemoryHead, "the memory");
ECS_BLOCK(EchoAsk, "the question");
ECS_BLOCK(ArmShare, "the host's share");
ECS_BLOCK(ArmConfirm, "the host's confirmation");
ECS_BLOCK(ArmAnswer, "the answer to an arming");
ECS_BLOCK(Command, "the command");
ECS_BLOCK(WindowOpen, "the window");
ECS_BLOCK(CheckSelect, "the selection");
ECS_BLOCK(ReadSelect, "the selection");
ECS_BLOCK(ResultSelect, "the selection");
ECS_BLOCK(SessionOpen, "the session");
ECS_BLOCK(EventSelect, "the selection");
#undef ECS_BLOCK

Registers pointer_registers_of(const UnitStatus& status, std::uint16_t echo) {
  FieldWriter pass;
  pass.number(echo, "echo");
  pointer_fields(pass, status);
  return std::move(pass.out_);
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

std::size_t blocks_in(std::uint32_t length, std::size_t block_bytes) {
  return (length + block_bytes - 1) / block_bytes;
}

std::size_t bytes_in_block(std::uint32_t length, std::size_t number, std::size_t block_bytes) {
  const std::size_t before = number * block_bytes;
  return before >= length ? 0 : std::min(block_bytes, length - before);
}

std::uint16_t crc16_of(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? (crc >> 1) ^ 0xA001u : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

bool crc_agrees(std::span<const std::uint8_t> frame) {
  if (frame.size() < 4) return false;
  const auto body = frame.first(frame.size() - 2);
  return crc16_of(body) == frame[body.size()] + (frame[body.size() + 1] << 8);
}

}  // namespace ecs::protocol
