// What host and unit tell each other, as plain values with their units.
// Does not live here: the registers that carry them (register_map.hpp, unit_registers.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/address_map.hpp"
#include "core/axis.hpp"
#include "core/fault.hpp"
#include "core/rotary.hpp"
#include "core/thermal.hpp"
#include "protocol/registers/keys.hpp"
#include "protocol/registers/register_map.hpp"

namespace ecs::protocol {

/// Who is at the far end.
struct Identity {
  std::uint16_t protocol_version = kProtocolVersion;
  std::uint16_t firmware_major = 0;
  std::uint16_t firmware_minor = 0;
  std::string serial_number;         ///< up to 16 characters
  std::string unit_name;             ///< up to 32 characters
  std::uint16_t memory_modules = 0;  ///< 1 … 5
  PerAxis<bool> axis_present{};
  std::uint32_t capacity_values = 0;  ///< error values that one map may hold
  std::string machine{};              ///< that the active map names, up to 40 bytes; empty: no map, or it names none
  std::uint32_t configuration = 0;    ///< configuration_hash() of the active map; 0: the unit holds no map
  friend bool operator==(const Identity&, const Identity&) = default;
};

enum class TestOutcome : std::uint16_t { not_run = 0, passed = 1, failed = 2 };
enum class Bank : std::uint16_t { none = 0, A = 1, B = 2 };

struct AxisStatus {
  bool referenced = false;
  DatumStage datum_stage = DatumStage::waiting;
  DatumFailure datum_failure = DatumFailure::none;
  double position_mm = 0.0;  ///< until referenced: counted from switch-on, or from the position set
  Approach last_approach = Approach::unknown;
  bool relay_closed = false;
  friend bool operator==(const AxisStatus&, const AxisStatus&) = default;
};

inline constexpr std::uint32_t kUnused = 0xFFFFFFFF;

/// Which value of a curve the unit selected last ("compensation address pointers", thesis 5.4).
struct CurvePointer {
  std::uint32_t index = kUnused;    ///< place in the curve, from 0; kUnused: the curve is not in use
  std::uint32_t address = kUnused;  ///< of that value in axis memory
  friend bool operator==(const CurvePointer&, const CurvePointer&) = default;
};

/// The state of the unit.
struct UnitStatus {
  UnitMode mode = UnitMode::starting;
  Fault fault = Fault::none;
  Address fault_address = 0;  ///< 24 bits; meaningful for ram_test and block_check
  std::optional<Axis> fault_axis;
  TestOutcome ram_test = TestOutcome::not_run;
  Address ram_test_address = 0;            ///< first failing location; meaningful when the test failed
  std::uint32_t block_check_expected = 0;  ///< CRC-32 stored with the active map
  std::uint32_t block_check_found = 0;     ///< CRC-32 computed over it at the last check
  Bank active_bank = Bank::none;
  std::uint32_t commit_sequence = 0;     ///< counts the maps committed
  std::uint32_t image_length_bytes = 0;  ///< of the active map
  double loop_period_us = 0.0;
  std::uint32_t loop_overruns = 0;
  std::uint64_t ticks = 0;  ///< periods of the loop since power-up
  std::uint32_t uptime_s = 0;
  std::uint16_t watchdog_trips = 0;
  PerAxis<AxisStatus> axes{};
  std::uint64_t pointers_at_tick = 0;  ///< the pointers travel in a block of their own, a moment later
  std::array<CurvePointer, kCurves> pointers{};
  friend bool operator==(const UnitStatus&, const UnitStatus&) = default;
};

/// What a transfer looks at: who answers and which map it holds, from one read.
struct ActiveMap {
  std::string serial_number;
  std::uint32_t block_check_expected = 0;  ///< as in the status
  std::uint32_t block_check_found = 0;
  Bank active_bank = Bank::none;
  std::uint32_t commit_sequence = 0;
  std::uint32_t image_length_bytes = 0;
  ImageDigest digest{};  ///< SHA-256 of the active image as the unit's memory holds it; zeros: no map
  friend bool operator==(const ActiveMap&, const ActiveMap&) = default;
};

struct AxisSample {
  bool present = false;
  double position_mm = 0.0;
  double speed_mm_min = 0.0;  ///< signed
  bool referenced = false;
  bool switch_active = false;
  bool marker = false;  ///< seen since the sample before
  Approach approach = Approach::unknown;
  double compensation_um = 0.0;    ///< what the unit adds now
  std::int32_t output_counts = 0;  ///< D/A
  bool relay_closed = false;
  friend bool operator==(const AxisSample&, const AxisSample&) = default;
};

/// What the on-line monitor shows; taken between two ticks, so that its numbers belong together.
struct MonitorSample {
  std::uint32_t number = 0;        ///< counts the samples taken
  std::uint64_t unit_time_us = 0;  ///< since power-up
  UnitMode mode = UnitMode::starting;
  Fault fault = Fault::none;
  PerAxis<AxisSample> axes{};
  friend bool operator==(const MonitorSample&, const MonitorSample&) = default;
};

struct InputStatus {
  InputState state = InputState::unused;
  double value = 0.0;        ///< that arrived last, degC, of the load kg
  std::uint16_t faults = 0;  ///< since the loop began
  bool wired = false;        ///< to a sensor; otherwise an armed host may set it
  friend bool operator==(const InputStatus&, const InputStatus&) = default;
};

/// The deviation that an instrument shows is with the lines (ControlLines): one more would not fit a block.
inline constexpr std::size_t kInputsInBlock = kLoadInput + 1;

/// The live inputs and the thermal rows that follow them (core/thermal.hpp).
struct LiveInputs {
  std::uint32_t stored_age_s =
      kUnused;             ///< age that the stored state of the lags had when the loop began; kUnused: none
  std::uint16_t rows = 0;  ///< of the map in the loop
  Vector3 thermal_um{};    ///< what the rows add to the compensation now
  std::array<InputStatus, kInputsInBlock> inputs{};  ///< temperatures 1 … 16, then the load
  friend bool operator==(const LiveInputs&, const LiveInputs&) = default;
};

/// Numbers travel: append only.
enum class ToolState : std::uint16_t {
  none = 0,      ///< none is selected: the tool offset of the parameters acts
  acting = 1,    ///< the selected one
  changing = 2,  ///< the output is on its way to the selected one
  unknown = 3,   ///< the selected number is not in the table, or none came: the one before acts
};
inline constexpr std::uint16_t kToolStateCount = 4;
[[nodiscard]] std::string_view name_of(ToolState state) noexcept;
enum class BatteryState : std::uint16_t { good = 0, low = 1 };

/// The wires between the unit and the control, the tool, and the battery that keeps the memory.
struct ControlLines {
  std::uint16_t tool = 0;  ///< selected last; 0: none
  ToolState tool_state = ToolState::none;
  Vector3 tool_offset_mm{};       ///< that acts now
  Vector3 squareness_um_per_m{};  ///< C0Y, B0Z, A0Z that are corrected now, tried ones included
  std::uint16_t tools = 0;        ///< in the table
  bool tool_wired = false;        ///< the control selects; otherwise an armed host does
  bool control_on_wired = false;  ///< the control's "power on" is wired to the unit
  bool control_on = true;         ///< what that wire says
  InputStatus deviation{};        ///< that an instrument on the machine shows, um
  bool compensating_out = false;  ///< output to the control: the unit compensates
  bool fault_out = false;         ///< output to the control: there is a fault
  BatteryState battery = BatteryState::good;
  std::uint32_t battery_age_s = 0;  ///< since it was new, by the clock that it keeps running
  friend bool operator==(const ControlLines&, const ControlLines&) = default;
};

/// A rotary axis of the active map.
struct RotaryAxisSample {
  char letter = '\0';      ///< A, B or C; '\0': no axis
  bool sensed = false;     ///< its transducer shows an angle
  double angle_deg = 0.0;  ///< that its absolute transducer shows, not reduced to a turn; 0 unless sensed
  Approach approach = Approach::unknown;  ///< known while the unit compensates
  friend bool operator==(const RotaryAxisSample&, const RotaryAxisSample&) = default;
};

/// The rotary axes of the active map, in its order; a map without them has none.
struct RotarySample {
  Vector3 compensation_um{};  ///< what their errors add to X, Y, Z now; part of that of the linear axes
  PerRotary<RotaryAxisSample> axes{};
  friend bool operator==(const RotarySample&, const RotarySample&) = default;
};
[[nodiscard]] inline bool any_axis(const RotarySample& sample) {
  return sample.axes[0].letter != '\0' || sample.axes[1].letter != '\0';
}
/// Whether the unit has the block of rotary axes: firmware 1.2 and later.
[[nodiscard]] inline bool shows_rotary(const Identity& identity) {
  return std::pair(identity.firmware_major, identity.firmware_minor) >= std::pair<std::uint16_t, std::uint16_t>(1, 2);
}

/// Why the unit does not do what it is asked. The number travels: append only.
enum class UnitError : std::uint16_t {
  none = 0,
  not_in_integration_mode = 1,  ///< everything but reading and `enter_integration` needs it
  address_unknown = 2,          ///< no memory there
  address_protected = 3,        ///< memory that the host may not write
  bad_argument = 4,
  unknown_command = 5,
  no_staging = 6,        ///< nothing staged, or no second bank
  check_mismatch = 7,    ///< the CRC over memory is not the announced one
  image_refused = 8,     ///< whole, but not a map or not for this unit: see the text
  busy = 9,              ///< another command is under way
  axis_absent = 10,      ///< the axis does not exist
  not_referenced = 11,   ///< the axis has no reference position yet
  unit_fault = 12,       ///< a fault prevents it: see the status
  stopped = 13,          ///< ended by `stop`
  time_out = 14,         ///< the unit gave up waiting: see the text
  token_expired = 15,    ///< the staging that this token named has ended
  other_machine = 16,    ///< an image that is addressed to another unit, machine or configuration: see the text
  session_unknown = 17,  ///< the unit was restarted, or has forgotten the session over those of other hosts
  late = 18,             ///< the command came more than kMostAge_ms after it was given
  overtaken = 19,        ///< after it was given, everything was switched off
  other_version = 20,    ///< the host speaks another version of the protocol
  not_armed = 21,        ///< the unit is read-only for this host
  wrong_code = 22,       ///< to arm the unit; see the text
  too_many_codes = 23,   ///< wrong codes: no code is looked at for a while; see the text
  wrong_key = 24,        ///< the keyed check is not that of this host's arming, or the exchange of keys failed
};
inline constexpr std::uint16_t kUnitErrorCount = 25;
/// In plain words, with what to do.
[[nodiscard]] std::string_view text_of(UnitError error) noexcept;

/// The number travels: append only.
enum class CommandCode : std::uint16_t {
  none = 0,
  enter_integration = 1,
  enter_compensation = 2,
  set_axis_position = 3,    ///< axis, position_mm
  output_compensation = 4,  ///< axis, output_um, relay_on
  output_off = 5,           ///< every output 0, every relay open
  begin_staging = 6,        ///< staging_from; result value = first address of the bank to write, and the token
  commit_staged = 7,        ///< length, digest, token
  abandon_staged = 8,       ///< token
  test_datum = 9,           ///< axis; ends when the sequence is done, failed or stopped
  record_datum = 10,        ///< axis; result value = address of the record, read with read_memory
  run_user_software = 11,   ///< address, argument; result value = what it returned
  run_ram_test = 12,        ///< result value = first failing address, kUnused if none
  clear_fault = 13,
  reset_unit = 14,    ///< answered `done` before the unit restarts
  check_memory = 15,  ///< address, length; result value = CRC-32 over that memory
  stop = 16,          ///< ends the command under way
  arm = 17,           ///< as a command it ends the arming of this host, which begins with an exchange (ArmShare)
  set_input = 18,     ///< input, input_value; in every mode; an input without a wire of its own
  select_tool = 19,   ///< tool; in every mode; refused where the control selects
  set_tool = 20,      ///< tool, tool_offset_mm: into the table, in every mode; an offset that acts is followed
  remove_tool = 21,   ///< tool; in every mode; not the selected one
  /// squareness_um_per_m: corrected from now on until the unit leaves compensation mode, only while it compensates
  try_squareness = 22,
  // the whole table of tools, in every mode: it is gathered beside the one in force, and replaces it in one piece
  begin_tools = 23,   ///< an empty table is begun
  stage_tool = 24,    ///< tool, tool_offset_mm: into it
  commit_tools = 25,  ///< length = number of tools, digest of them (tools_digest()): it replaces the one in force
};
inline constexpr std::uint16_t kCommandCount = 26;
[[nodiscard]] std::string_view name_of(CommandCode code) noexcept;

/// What the bank to write holds when a staging begins.
enum class StagingFrom : std::uint16_t {
  cleared = 0,  ///< zeros
  active = 1,   ///< a copy of the active bank
  kept = 2,     ///< what is there: of a staging that was cut, or of an older map
};

/// What closes a relay, moves an axis or changes how the unit takes the machine: carried out within kMostAge_ms of the
/// unit's clock, and only if nothing was switched off in between.
[[nodiscard]] bool acts_at_once(CommandCode code) noexcept;
inline constexpr std::uint32_t kMostAge_ms = 2000;
/// Switches off: whatever was given before it and comes after it is not carried out.
[[nodiscard]] bool switches_off(CommandCode code) noexcept;

/// Writes, moves, closes a relay or runs code: only for a host that is armed.
[[nodiscard]] bool needs_arming(CommandCode code) noexcept;

/// Longest time that a host can be armed.
inline constexpr std::uint16_t kMostArmed_min = 1440;
inline constexpr std::uint16_t kUsualArmed_min = 30;
/// Who asks: an answer to it ends with a check under the key of that session.
struct Asker {
  std::uint32_t session = 0;    ///< 0: nobody, the answer has no check
  std::uint32_t challenge = 0;  ///< a number that this host never sends again in this session
  friend bool operator==(const Asker&, const Asker&) = default;
};
/// Before a plain answer block.
struct EchoAsk {
  Asker asker{};
  friend bool operator==(const EchoAsk&, const EchoAsk&) = default;
};

/// The first half of the exchange that arms a host (keys.hpp): its share. The session is the exchange's "sid".
struct ArmShare {
  std::uint32_t session = 0;
  std::uint16_t minutes = 0;  ///< 1 … kMostArmed_min
  Share share{};
  friend bool operator==(const ArmShare&, const ArmShare&) = default;
};
/// The second half: that the host has derived the key. The unit answers with its own confirmation only then, so each
/// guess of the code costs a try at the unit.
struct ArmConfirm {
  std::uint32_t session = 0;
  Confirmation confirmation{};
  friend bool operator==(const ArmConfirm&, const ArmConfirm&) = default;
};
struct ArmAnswer {
  UnitError error = UnitError::none;
  std::uint16_t wait_s = 0;     ///< before another code is looked at
  Share share{};                ///< of the unit; zeros: there is no exchange
  Confirmation confirmation{};  ///< of the unit; zeros: not armed
  std::uint32_t armed_s = 0;
  friend bool operator==(const ArmAnswer&, const ArmAnswer&) = default;
};
/// What both ends put into that exchange.
[[nodiscard]] ExchangeTerms exchange_terms(std::string_view code, std::string_view serial_number, std::uint32_t session,
                                           std::uint16_t minutes);

/// A host makes itself known. The same key and number again: the same session, as long as the unit remembers it.
struct SessionOpen {
  std::uint32_t challenge = 0;  ///< see Asker
  std::uint16_t protocol_version = kProtocolVersion;
  std::uint64_t key = 0;          ///< names the host, by chance; kept from one program to the next; no secret
  std::uint32_t number = 0;       ///< of this program on that host, by chance
  std::uint32_t unix_time_s = 0;  ///< the host's clock
  std::string host;               ///< up to 16 characters, for the unit's records
  friend bool operator==(const SessionOpen&, const SessionOpen&) = default;
};

/// What the unit answers to it.
struct SessionState {
  std::uint16_t protocol_version = kProtocolVersion;
  UnitError error = UnitError::none;
  std::uint32_t session = 0;   ///< by chance; 0: none was opened
  std::uint32_t sequence = 0;  ///< of the last command that came in it
  std::uint32_t window = 0;    ///< number of the last window that it opened
  std::uint32_t clock_ms = 0;  ///< the unit's, since power-up, modulo 2³²
  std::uint16_t stops = 0;     ///< commands that switched off, modulo 2¹⁶
  std::uint32_t armed_s = 0;   ///< the host is armed for so long yet
  std::uint16_t wait_s = 0;    ///< before the unit looks at another code
  bool needs_code = false;     ///< the unit shows a code; otherwise the empty one arms
  std::uint64_t nonce = 0;     ///< of the session, see session_key()
  friend bool operator==(const SessionState&, const SessionState&) = default;
};

enum class CommandState : std::uint16_t { idle = 0, busy = 1, done = 2, refused = 3, failed = 4 };
[[nodiscard]] std::string_view name_of(CommandState state) noexcept;

/// Of a tool offset in a command.
inline constexpr double kToolStep_mm = 1e-4;
/// The offset as it arrives.
[[nodiscard]] Vector3 in_tool_steps(const Vector3& offset_mm) noexcept;
/// Of the tools of a table, wherever they are in it: the first 8 bytes of a SHA-256.
[[nodiscard]] std::uint64_t tools_digest(const ToolTable& table);
/// How many of the two slots of the record hold something that is no table. @param record  kToolRecord
[[nodiscard]] std::size_t damaged_tool_slots(ByteView record) noexcept;
inline constexpr double kSquarenessStep_um_per_m = 1e-4;  ///< of a squareness value in a command

/// What a host did to the unit, or tried.
struct HostEvent {
  std::uint32_t number = 0;              ///< counts from 1; 0: no such event
  std::uint32_t unit_time_s = 0;         ///< the unit's clock, since its start
  std::uint32_t unix_time_s = 0;         ///< the host's clock, as it said; 0: unknown
  std::uint16_t starts = 0;              ///< how often the unit had started, modulo 2¹⁶
  std::uint16_t times = 1;               ///< the same, so often in a row
  CommandCode code = CommandCode::none;  ///< none: memory was written
  UnitError error = UnitError::none;
  CommandState state = CommandState::idle;
  std::string host;  ///< up to 16 characters
  std::string text;  ///< up to 24 characters: the arguments
  friend bool operator==(const HostEvent&, const HostEvent&) = default;
};

/// Events from a number on.
struct EventPage {
  std::uint32_t newest = 0;  ///< number of the newest event
  std::array<HostEvent, kEventsInBlock> events{};
  friend bool operator==(const EventPage&, const EventPage&) = default;
};
struct EventSelect {
  std::uint32_t first = 1;
  friend bool operator==(const EventSelect&, const EventSelect&) = default;
};

/// Whose result is read.
struct ResultSelect {
  Asker asker{};
  std::uint32_t sequence = 0;
  friend bool operator==(const ResultSelect&, const ResultSelect&) = default;
};

/// One command. Only the fields that its code names (above) travel.
struct Command {
  std::uint32_t sequence = 0;  ///< counts the commands of a session; a repeat is not done twice
  CommandCode code = CommandCode::none;
  Axis axis = Axis::X;
  double position_mm = 0.0;
  double output_um = 0.0;
  std::uint16_t input = 0;   ///< 0 … 15 temperature, 16 load
  double input_value = 0.0;  ///< degC, kg
  std::uint16_t tool = 0;
  Vector3 tool_offset_mm{};       ///< travels in steps of kToolStep_mm
  Vector3 squareness_um_per_m{};  ///< C0Y, B0Z, A0Z; travel in steps of kSquarenessStep_um_per_m
  bool relay_on = false;
  StagingFrom staging_from = StagingFrom::cleared;
  Address address = 0;
  std::uint32_t argument = 0;
  std::uint32_t length = 0;
  std::uint64_t digest = 0;  ///< the first 8 bytes of the SHA-256 of the image
  std::uint32_t token = 0;   ///< of the staging
  Asker asker{};
  std::uint32_t clock_ms = 0;  ///< of the unit, when the command was given
  std::uint16_t stops = 0;     ///< of the unit, when the command was given
  friend bool operator==(const Command&, const Command&) = default;
};

struct CommandResult {
  std::uint32_t sequence = 0;  ///< of the command that this answers
  CommandState state = CommandState::idle;
  UnitError error = UnitError::none;
  std::uint16_t per_mille = 0;  ///< how far a busy command is, if the unit knows
  std::uint32_t value = 0;      ///< see CommandCode
  std::string text;             ///< up to 80 characters, shown to the user
  std::uint32_t token = 0;      ///< of the staging that was started
  std::uint32_t session = 0;
  friend bool operator==(const CommandResult&, const CommandResult&) = default;
};

/// Which stretch of memory the window writes. A higher number starts afresh; the same one again changes nothing; a
/// lower one of the session is not opened.
struct WindowOpen {
  std::uint32_t number = 0;  ///< counts the windows of a session from 1; 0: no window
  Address address = 0;
  std::uint32_t length = 0;  ///< 1 … kWindowBytes
  std::uint32_t token = 0;   ///< of the staging that it belongs to; 0 outside axis memory
  bool coded = false;        ///< blocks of 120 bytes, several in a frame, coded (core/block_code.hpp); axis memory only
  Asker asker{};
  /// That its blocks carry.
  [[nodiscard]] std::uint16_t tag() const { return static_cast<std::uint16_t>(number); }
  [[nodiscard]] std::size_t block_bytes() const { return coded ? kCodedBlockBytes : kBlockBytes; }
  friend bool operator==(const WindowOpen&, const WindowOpen&) = default;
};

/// What of the open window has arrived.
struct WindowAck {
  std::uint32_t number = 0;
  UnitError error = UnitError::none;
  Address address = 0;
  std::uint32_t length = 0;
  std::uint64_t received = 0;  ///< bit n: block n arrived intact and is in memory
  std::uint32_t crc = 0;       ///< CRC-32 over the window as memory now holds it; 0 until every block is there
  friend bool operator==(const WindowAck&, const WindowAck&) = default;
};

/// The bytes that have a check each: pieces from `address` on, the last may be shorter.
struct CheckSelect {
  Asker asker{};
  Address address = 0;
  std::uint32_t length = 0;
  std::uint16_t piece = 0;  ///< bytes, above 0; at most kMostChecks pieces
  friend bool operator==(const CheckSelect&, const CheckSelect&) = default;
};

struct ReadSelect {
  Address address = 0;
  std::uint16_t bytes = 0;  ///< 1 … kMemoryBytes; with an asker kKeyedMemoryBytes
  Asker asker{};
  friend bool operator==(const ReadSelect&, const ReadSelect&) = default;
};

/// Before the bytes that are read.
struct MemoryHead {
  Address address = 0;
  std::uint32_t crc = 0;  ///< CRC-32 over them
};

}  // namespace ecs::protocol
