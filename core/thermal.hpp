// Thermal and load terms in the loop (thesis 9.1, 9.3) and active compensation (9.6): rows of the memory image that
// follow live inputs, the watch over those inputs, and the slow loop that turns both into what a tick adds. A row adds,
// along every direction in which its component acts,
//   shift  c·D        growth  c·p·D        bending  c·p²·D        active  c·D        with p from its origin [m],
// where D follows, with a lag of first order, one input less a reference, or the difference of two inputs (ISO 230-3).
// Of an active row D works against a measured deviation until nothing of it is left: D' = −deviation / lag, within
// ±reference.
// No heap, no exception, bounded time. Does not live here: the bytes (memory_image.hpp), the tick (tick.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/axis.hpp"
#include "core/bytes.hpp"
#include "core/pair.hpp"

namespace ecs {

struct UnitParameters;

inline constexpr std::size_t kTemperatureInputs = 16;
inline constexpr std::size_t kLoadInput = kTemperatureInputs;           ///< the mass on the machine, kg
inline constexpr std::size_t kDeviationInput = kTemperatureInputs + 1;  ///< what an instrument on the machine shows, um
inline constexpr std::size_t kLiveInputs = kTemperatureInputs + 2;  ///< temperatures 0 … 15, load 16, deviation 17
inline constexpr std::size_t kToolInput = kLiveInputs;              ///< in faults alone: the number of the tool
inline constexpr std::size_t kMostThermalRows = 32;
inline constexpr std::uint8_t kNoInput = 255;

/// What a row follows: a live input, or the motion of an axis, which warms a machine without a sensor. Numbers are
/// stored: 0 … 16 an input, 17 … 19 the motion of X, Y, Z, 20 the deviation.
inline constexpr std::uint8_t kMotionOfX = 17;
inline constexpr std::uint8_t kDeviationSource = kMotionOfX + kAxes;
inline constexpr std::uint8_t kThermalSources = kDeviationSource + 1;
[[nodiscard]] constexpr bool follows_motion(std::uint8_t source) noexcept {
  return source >= kMotionOfX && source < kDeviationSource;
}
/// The live input that a row follows; nothing: motion, or no input at all.
[[nodiscard]] constexpr std::optional<std::size_t> input_of_source(std::uint8_t source) noexcept {
  if (source == kDeviationSource) return kDeviationInput;
  if (source < kMotionOfX) return source;
  return std::nullopt;
}

enum class ThermalLaw : std::uint8_t { shift, growth, bending, active };
inline constexpr std::uint8_t kThermalLaws = 4;

[[nodiscard]] std::string_view name_of(ThermalLaw law) noexcept;
[[nodiscard]] std::optional<ThermalLaw> thermal_law_named(std::string_view word) noexcept;

struct ThermalRow {
  Component component = Component::EXX;  ///< a curve: its direction and its axis; a rotation only with `shift`
  ThermalLaw law = ThermalLaw::shift;
  std::uint8_t source = 0;        ///< 0 … 15 temperature, 16 load, 17 … 19 motion of X, Y, Z, 20 deviation
  std::uint8_t minus = kNoInput;  ///< temperature that is taken off; kNoInput: the reference is
  /// Of compensation (−error): um, um/m or um/m² (of a rotation um/m) for each degC or kg; of motion at full duty.
  double coefficient = 0.0;
  /// degC or kg at which the row is zero; of motion the mean speed of full duty, mm/min; of an active row its limit,
  /// um.
  double reference = 20.0;
  double lag_s = 0.0;  ///< time constant with which the machine follows the input; 0: none. Of an active row above 0
  double origin_mm = 0.0;  ///< machine coordinate from which p counts
  friend bool operator==(const ThermalRow&, const ThermalRow&) = default;
};

/// When an input is believed, and how fast the terms may act.
struct ThermalSettings {
  double rate_um_per_s = 0.5;       ///< of all rows together at the place of the machine; they also fade at it
  double hold_s = 60.0;             ///< a doubtful input keeps its last good value so long, then its rows fade out
  double longest_age_s = 10.0;      ///< without a new value: missing
  double stuck_s = 3600.0;          ///< the same value to the last digit: stuck; 0: not watched
  double fastest_degC_per_s = 0.1;  ///< no part of a machine warms faster
  double step_degC = 1.0;           ///< further than this from where that rate allows: jumping
  double least_degC = -30.0;
  double greatest_degC = 120.0;
  friend bool operator==(const ThermalSettings&, const ThermalSettings&) = default;
};
inline constexpr double kGreatestLoad_kg = 1e6;
inline constexpr double kLargestDeviation_um = 1000.0;  ///< of an instrument that works

/// Finite, and within ranges in which the loop can neither overflow nor divide by zero.
[[nodiscard]] bool sound(const ThermalRow& row) noexcept;
[[nodiscard]] bool sound(const ThermalSettings& settings) noexcept;

/// X, Y, Z and one lane unused, so that the compiler makes vector instructions of it.
using Lanes = std::array<double, 4>;

/// Compensation along X, Y, Z as a polynomial of the position, um: offset + Σ p_a (gain_a + bend_a p_a), p in mm.
struct alignas(16) ThermalPolynomial {
  Lanes offset{};
  PerAxis<Lanes> gain{};
  PerAxis<Lanes> bend{};
  friend bool operator==(const ThermalPolynomial&, const ThermalPolynomial&) = default;
};
[[nodiscard]] inline Lanes value_um(const ThermalPolynomial& of, const Vector3& position_mm) noexcept {
  Pair xy = pair_at(of.offset.data()), z = pair_at(&of.offset[2]);
  for (std::size_t a = 0; a < kAxes; ++a) {
    const Pair p = twice(position_mm[a]);
    xy += p * (pair_at(of.gain[a].data()) + pair_at(of.bend[a].data()) * p);
    z += p * (pair_at(&of.gain[a][2]) + pair_at(&of.bend[a][2]) * p);
  }
  return {xy[0], xy[1], z[0], z[1]};
}

/// The rows of a map, compiled for the chain, scope and tool of its parameters.
struct ThermalWorking {
  struct Row {
    ThermalPolynomial of_one{};  ///< for D = 1, with the tool offset
    PerAxis<Lanes> of_tool{};    ///< of its offset, for D = 1 and each mm of a tool offset along x, y, z
    Lanes without_tool{};        ///< its offset without a tool
    std::uint8_t source = 0;
    std::uint8_t minus = kNoInput;
    double reference = 0.0;
    double lag_s = 0.0;
    bool active = false;
  };
  ThermalSettings settings{};
  std::array<Row, kMostThermalRows> rows{};
  std::size_t count = 0;
};
/// @pre every row and the settings are sound, at most kMostThermalRows
void compile_thermal(std::span<const ThermalRow> rows, const ThermalSettings& settings,
                     const UnitParameters& parameters, ThermalWorking& working) noexcept;

/// Numbers travel: append only.
enum class InputState : std::uint16_t {
  unused = 0,  ///< no row follows it
  good = 1,
  missing = 2,  ///< never came, or not for `longest_age_s`
  out_of_range = 3,
  jumping = 4,  ///< away from where the fastest warming could have brought it
  stuck = 5,    ///< the same to the last digit for `stuck_s`
};
inline constexpr std::uint16_t kInputStateCount = 6;
[[nodiscard]] std::string_view name_of(InputState state) noexcept;
[[nodiscard]] constexpr bool is_doubtful(InputState state) noexcept { return state > InputState::good; }

/// What arrives at an input.
struct InputValue {
  double value = 0.0;        ///< degC, of the load kg, of the deviation um; any number
  bool present = false;      ///< false: nothing is connected, or the wire is open
  std::uint32_t number = 0;  ///< another number: a new value
};
using InputValues = std::array<InputValue, kLiveInputs>;

struct ThermalState {
  struct Input {
    InputState state = InputState::unused;
    double held = 0.0;  ///< the last good value, which the rows use; it moves no faster than the fastest warming
    bool has_value = false;
    std::uint16_t faults = 0;  ///< since the loop began, up to 65,535
    InputValue last{};
    double age_s = 0.0;       ///< since the last new value
    double same_s = 0.0;      ///< since the value changed
    double doubtful_s = 0.0;  ///< since it was last believed
    double good_s = 0.0;      ///< plausible again for so long, while doubtful
  };
  std::array<Input, kLiveInputs> inputs{};
  std::array<double, kMostThermalRows> lagged{};   ///< D after its lag
  std::array<double, kMostThermalRows> applied{};  ///< D as it acts: limited in rate, faded
  std::array<bool, kMostThermalRows> has_begun{};
  Vector3 position_mm{};                 ///< at the last step
  std::optional<double> stored_age_s{};  ///< age of the stored state from which the loop began; nothing: none
  ThermalPolynomial acting{};            ///< what a tick adds
};

/// A doubtful input is believed again when it has been plausible for so long.
inline constexpr double kBelievedAfter_s = 10.0;

/// What survives without power: D of every row after its lag.
struct StoredThermal {
  std::uint32_t sequence = 0;
  std::uint32_t image_check = 0;  ///< of the map to which the rows belong
  double clock_s = 0.0;           ///< of the clock that the battery keeps running
  std::array<double, kMostThermalRows> lagged{};
  friend bool operator==(const StoredThermal&, const StoredThermal&) = default;
};
inline constexpr std::uint32_t kStoredThermalBytes = 320;  ///< of one slot of two
/// The newer sound slot; nothing: neither is. @param region  two slots
[[nodiscard]] std::optional<StoredThermal> stored_thermal(ByteView region) noexcept;
/// The slot (0 or 1) to overwrite next: never the newer one.
[[nodiscard]] std::uint32_t next_thermal_slot(ByteView region) noexcept;
/// @pre slot.size() == kStoredThermalBytes
void encode_thermal(const StoredThermal& stored, Bytes slot) noexcept;

/// Before the first tick: the rows act at once with what the inputs show. A row with a lag begins where the stored
/// state, as old as it is, has come to meanwhile; without one it begins in balance with its input, and of motion cold.
/// @param stored  null: none of this map  @param age_s  of `stored`
/// @return  an input that a row follows has no good value
bool begin_thermal(const ThermalWorking& working, ThermalState& state, const InputValues& inputs,
                   const Vector3& position_mm, const StoredThermal* stored, double age_s) noexcept;

/// One step of the slow loop. No input, whatever it does, moves the output faster than `rate_um_per_s`.
/// @param seconds  since the last one; 0: the inputs are judged, nothing moves
/// @return  an input has become doubtful
bool step_thermal(const ThermalWorking& working, ThermalState& state, const InputValues& inputs,
                  const Vector3& position_mm, double seconds) noexcept;

/// The rows act with another tool offset from now on.
void set_tool_of_rows(ThermalWorking& working, ThermalState& state, const Vector3& tool_offset_mm) noexcept;
/// What the rows add along X, Y, Z for each mm of a tool offset along x, y, z, um.
[[nodiscard]] PerAxis<Vector3> thermal_tool_effect_um_per_mm(const ThermalWorking& working,
                                                             const ThermalState& state) noexcept;

/// Steps of the slow loop lie this far apart: the output steps by 0.05 um at the usual rate, by 0.2 um at the greatest.
inline constexpr double kThermalStep_s = 0.1;

}  // namespace ecs
