// What host and unit tell each other, as plain values with their units.
// Does not live here: the registers that carry them (register_map.hpp, unit_registers.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/address_map.hpp"
#include "core/axis.hpp"
#include "core/component.hpp"
#include "core/fault.hpp"
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
  [[nodiscard]] std::size_t axis_count() const;
  friend bool operator==(const Identity&, const Identity&) = default;
};

enum class TestOutcome : std::uint16_t { not_run = 0, passed = 1, failed = 2 };
enum class Bank : std::uint16_t { none = 0, A = 1, B = 2 };

struct AxisStatus {
  bool referenced = false;
  DatumStage datum_stage = DatumStage::waiting;
  DatumFailure datum_failure = DatumFailure::none;
  double position_mm = 0.0;  ///< machine coordinates; meaningless until referenced
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

/// Why the unit does not do what it is asked. The number travels: append only.
enum class UnitError : std::uint16_t {
  none = 0,
  not_in_integration_mode = 1,  ///< everything but reading and `enter_integration` needs it
  address_unknown = 2,          ///< no memory there
  address_protected = 3,        ///< memory that the host may not write
  bad_argument = 4,
  unknown_command = 5,
  no_staging = 6,       ///< nothing staged, or no second bank
  check_mismatch = 7,   ///< the CRC over memory is not the announced one
  image_refused = 8,    ///< whole, but not a map or not for this unit: see the text
  busy = 9,             ///< another command is under way
  axis_absent = 10,     ///< the axis does not exist
  not_referenced = 11,  ///< the axis has no reference position yet
  unit_fault = 12,      ///< a fault prevents it: see the status
  stopped = 13,         ///< ended by `stop`
  time_out = 14,        ///< the unit gave up waiting: see the text
  token_expired = 15,   ///< the staging that this token named has ended
  other_machine = 16,   ///< an image that is addressed to another unit, machine or configuration: see the text
};
inline constexpr std::uint16_t kUnitErrorCount = 17;
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
  commit_staged = 7,        ///< length, crc, token
  abandon_staged = 8,       ///< token
  test_datum = 9,           ///< axis; ends when the sequence is done, failed or stopped
  record_datum = 10,        ///< axis; result value = address of the record, read with read_memory
  run_user_software = 11,   ///< address, argument; result value = what it returned
  run_ram_test = 12,        ///< result value = first failing address, kUnused if none
  clear_fault = 13,
  reset_unit = 14,    ///< answered `done` before the unit restarts
  check_memory = 15,  ///< address, length; result value = CRC-32 over that memory
  stop = 16,          ///< ends the command under way
};
inline constexpr std::uint16_t kCommandCount = 17;
[[nodiscard]] std::string_view name_of(CommandCode code) noexcept;

/// What the bank to write holds when a staging begins.
enum class StagingFrom : std::uint16_t {
  cleared = 0,  ///< zeros
  active = 1,   ///< a copy of the active bank
  kept = 2,     ///< what is there: of a staging that was cut, or of an older map
};

/// One command. Only the fields that its code names (above) travel.
struct Command {
  std::uint16_t sequence = 0;  ///< differs from the command before; a repeat is not done twice
  CommandCode code = CommandCode::none;
  Axis axis = Axis::X;
  double position_mm = 0.0;
  double output_um = 0.0;
  bool relay_on = false;
  StagingFrom staging_from = StagingFrom::cleared;
  Address address = 0;
  std::uint32_t argument = 0;
  std::uint32_t length = 0;
  std::uint32_t crc = 0;    ///< CRC-32 (IEEE 802.3)
  std::uint32_t token = 0;  ///< of the staging
  friend bool operator==(const Command&, const Command&) = default;
};

enum class CommandState : std::uint16_t { idle = 0, busy = 1, done = 2, refused = 3, failed = 4 };

struct CommandResult {
  std::uint16_t sequence = 0;  ///< of the command that this answers
  CommandState state = CommandState::idle;
  UnitError error = UnitError::none;
  std::uint16_t per_mille = 0;  ///< how far a busy command is, if the unit knows
  std::uint32_t value = 0;      ///< see CommandCode
  std::string text;             ///< up to 80 characters, shown to the user
  std::uint32_t token = 0;      ///< of the staging that was begun
  friend bool operator==(const CommandResult&, const CommandResult&) = default;
};

/// Which stretch of memory the window writes. A new tag starts afresh; the same tag again changes nothing.
struct WindowOpen {
  std::uint16_t tag = 0;  ///< 0: no window
  Address address = 0;
  std::uint32_t length = 0;  ///< 1 … kWindowBytes
  std::uint32_t token = 0;   ///< of the staging that it belongs to; 0 outside axis memory
  bool coded = false;        ///< blocks of 120 bytes, several in a frame, coded (core/block_code.hpp); axis memory only
  [[nodiscard]] std::size_t block_bytes() const { return coded ? kCodedBlockBytes : kBlockBytes; }
  friend bool operator==(const WindowOpen&, const WindowOpen&) = default;
};

/// What of the open window has arrived.
struct WindowAck {
  std::uint16_t tag = 0;
  UnitError error = UnitError::none;
  Address address = 0;
  std::uint32_t length = 0;
  std::uint64_t received = 0;  ///< bit n: block n arrived intact and is in memory
  std::uint32_t crc = 0;       ///< CRC-32 over the window as memory now holds it; 0 until every block is there
  friend bool operator==(const WindowAck&, const WindowAck&) = default;
};

/// The bytes that have a check each: pieces from `address` on, the last may be shorter.
struct CheckSelect {
  Address address = 0;
  std::uint32_t length = 0;
  std::uint16_t piece = 0;  ///< bytes, above 0; at most 60 pieces
  friend bool operator==(const CheckSelect&, const CheckSelect&) = default;
};

struct ReadSelect {
  Address address = 0;
  std::uint16_t bytes = 0;  ///< 1 … kMemoryBytes
  friend bool operator==(const ReadSelect&, const ReadSelect&) = default;
};

}  // namespace ecs::protocol
