// Modes, faults and datum stages of the unit (thesis 5.3), as numbers that travel and are stored.
#pragma once

#include <cstdint>
#include <string_view>

namespace ecs {

enum class UnitMode : std::uint16_t {
  starting = 0,      ///< power-up: tests not finished
  integration = 1,   ///< relays off; the host may write
  datuming = 2,      ///< compensation mode, waiting for every axis to be referenced
  compensating = 3,  ///< relays on, loop running
  halted = 4,        ///< fatal fault: relays off, reads answered, only a power cycle helps
};

/// Why the unit is not compensating. The number is part of the contract: append only.
enum class Fault : std::uint16_t {
  none = 0,
  ram_test = 1,                ///< a location of the axis memory does not hold what is written; address known
  block_check = 2,             ///< axis memory corrupt: the checksum does not agree
  no_map = 3,                  ///< axis memory holds no committed map
  map_not_for_parameters = 4,  ///< a component the scope needs is missing, or the chain differs
  bad_parameters = 5,          ///< parameters out of range
  compensation_output = 6,     ///< D/A value out of its limits for longer than the allowed time
  axis_module = 7,             ///< transducer signal lost or axis module does not answer
  datum_sequence = 8,          ///< the datum routine saw something its parameters do not allow
  loop_overrun = 9,            ///< the loop did not finish within its period
  watchdog = 10,               ///< the processor stopped serving the watchdog: fatal
  position_jump = 11,          ///< an axis moved further in one period than any axis can
  user_software = 12,          ///< user software left its bounds or its time
  commit_record = 13,          ///< a commit record is damaged: neither erased nor sound
  live_input = 14,             ///< a temperature, load or tool is missing or implausible; the loop goes on
  unknown_input = 15,          ///< nobody knows which tool or load, and the output could be wrong by more than a limit
};
inline constexpr std::uint16_t kFaultCount = 16;

/// One sentence in plain words, and what to do next.
struct FaultText {
  std::string_view name;     ///< "ram_test"
  std::string_view meaning;  ///< what happened
  std::string_view action;   ///< what to do next
};
[[nodiscard]] FaultText text_of(Fault fault) noexcept;
[[nodiscard]] std::string_view name_of(UnitMode mode) noexcept;

/// Stage of the datum routine of one axis.
enum class DatumStage : std::uint16_t {
  waiting = 0,         ///< the axis has not moved
  seeking_switch = 1,  ///< moving towards the reference switch
  on_switch = 2,       ///< switch active
  seeking_marker = 3,  ///< switch sequence complete, next marker is the datum
  done = 4,            ///< referenced
  failed = 5,          ///< see DatumFailure
};
inline constexpr std::uint16_t kDatumStageCount = 6;
enum class DatumFailure : std::uint16_t {
  none = 0,
  wrong_initial_state = 1,  ///< the switch was not in its initial state when the axis started
  wrong_direction = 2,      ///< the switch was reached while moving against the approach direction
  too_fast = 3,             ///< the switch was reached at more than 1.5 × the approach speed
  wrong_final_state = 4,    ///< the marker came while the switch was not in its final state
  no_reversal = 5,          ///< the axis was expected to turn back off the switch and did not
  no_marker = 6,            ///< no marker within the distance that one revolution allows
  stopped_early = 7,        ///< the axis stopped on its switch where it should go on
};
inline constexpr std::uint16_t kDatumFailureCount = 8;
[[nodiscard]] std::string_view name_of(DatumStage stage) noexcept;
[[nodiscard]] std::string_view name_of(DatumFailure failure) noexcept;
/// What the failure means and which parameter to look at.
[[nodiscard]] std::string_view advice_for(DatumFailure failure) noexcept;

}  // namespace ecs
