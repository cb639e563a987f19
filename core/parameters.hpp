// Everything that makes a unit fit its machine (thesis 5.3: configuration, compensation and datuming parameters),
// as the unit holds it. Plain values; names, ranges, help and TOML live in params/, the bytes in memory_image.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/axis.hpp"
#include "core/terms.hpp"

namespace ecs {

inline constexpr std::size_t kMostModules = 5;           ///< axis memory modules a rack holds (thesis 5.2)
inline constexpr std::size_t kValuesPerModule = 32'000;  ///< error values one module holds, one map
inline constexpr std::size_t kMostValues = kMostModules * kValuesPerModule;

enum class Transducer : std::uint8_t { encoder, resolver };
enum class MeasurementSystem : std::uint8_t { metric, imperial };  ///< how the CNC shows positions; inside all is mm
enum class Interpolation : std::uint8_t {
  nearest,  ///< value k acts for |p − p_k| < half an increment, in either direction (thesis 3.4)
  linear,
};

/// How the CNC finds its reference; the unit mimics it (thesis 5.3; docs/unit.md says what each kind expects).
enum class DatumKind : std::uint8_t {
  fanuc,          ///< onto the switch, on through it, first marker after leaving it, same direction
  allen_bradley,  ///< onto the switch, back off it, first marker in the reverse direction
  siemens,        ///< onto the switch at approach speed, first marker while still on it
};

struct DatumParameters {
  DatumKind kind = DatumKind::fanuc;
  std::int8_t switch_polarity = 1;        ///< +1: closed reads as active; −1: open reads as active
  bool switch_initially_active = false;   ///< state of the switch when the routine may begin
  bool switch_finally_active = false;     ///< state of the switch when the marker is taken
  double approach_speed_mm_min = 1000.0;  ///< above zero; the axis must not be faster than 1.5 × this on the switch
  Approach approach_direction = Approach::forward;  ///< direction of travel onto the switch
  double null_offset_mm = 0.0;                      ///< from the marker to the reference position
  double reference_position_mm = 0.0;               ///< machine coordinate of the reference position
  friend bool operator==(const DatumParameters&, const DatumParameters&) = default;
};

struct AxisParameters {
  Transducer transducer = Transducer::encoder;
  double position_scale_um_per_count = 1.0;  ///< position feedback scaling factor; sign = wiring polarity; not 0
  double deadband_um = 5.0;                  ///< minimum distance to qualify as a move
  double output_scale_counts_per_um = 10.0;  ///< compensation output value scaling factor; above 0
  std::int8_t compensation_polarity = 1;     ///< +1: the map's values (compensation = −error) are added
  double output_limit_um = 500.0;          ///< size limit of the compensation; beyond it the value is held and flagged
  double output_slew_um_per_s = 10'000.0;  ///< slew limit of the compensation
  double position_loop_gain_per_s = 30.0;  ///< velocity per distance of the CNC's position loop (Kv), above 0
  DatumParameters datum{};
  friend bool operator==(const AxisParameters&, const AxisParameters&) = default;
};

struct UnitParameters {
  // configuration
  std::array<char, 5> configuration{'T', 'X', 'Y', 'Z', 0};  ///< chain string, zero-terminated
  PerAxis<bool> axis_present{true, true, true};
  MeasurementSystem measurement_system = MeasurementSystem::metric;
  // compensation
  std::uint8_t memory_modules = 1;  ///< 1 … 5
  Scope scope = Scope::volumetric;
  Plane plane{};  ///< for Scope::planar
  Interpolation interpolation = Interpolation::linear;
  Convention convention = Convention::iso;
  double loop_period_us = 1000.0;  ///< 100 … 20 000
  double angular_scale = 1.0;      ///< multiplies every angular term
  double C0Y_um_per_m = 0.0;       ///< squareness *errors* (parameters hold errors, maps compensation)
  double B0Z_um_per_m = 0.0;
  double A0Z_um_per_m = 0.0;
  Vector3 tool_offset_mm{};  ///< of the tool that the unit reckons with while none of its table (tools.hpp) is selected
  MeasurementLines measurement_lines_mm{};
  PerAxis<AxisParameters> axes{};
  // tools and loads that change while the unit compensates
  Vector3 tool_range_mm{};               ///< no offset in the table of tools is larger; all 0: no tool is selected
  double tool_rate_um_per_s = 20.0;      ///< the output follows another tool no faster; above 0
  double load_range_kg = 0.0;            ///< no load is larger; 0: not stated
  double unknown_input_limit_um = 20.0;  ///< beyond it an unknown tool or load isolates the unit
  friend bool operator==(const UnitParameters&, const UnitParameters&) = default;
};

/// The squareness error of C0Y, B0Z or A0Z, um/m. @pre is_squareness(component)
[[nodiscard]] double& squareness_um_per_m(UnitParameters& parameters, Component component) noexcept;
[[nodiscard]] double squareness_um_per_m(const UnitParameters& parameters, Component component) noexcept;

/// The configuration string without its padding.
[[nodiscard]] std::string_view configuration_of(const UnitParameters& parameters) noexcept;

/// The chain of the present axes; nothing if the string is no chain or lacks a present axis.
[[nodiscard]] std::optional<Chain> chain_of(const UnitParameters& parameters) noexcept;

/// The terms that a unit with these parameters corrects: measured curves, scope applied, no row without a lever.
[[nodiscard]] std::optional<TermTable> terms_of(const UnitParameters& parameters) noexcept;

/// The components that a map for these parameters must hold or declare zero.
[[nodiscard]] ComponentSet components_needed(const UnitParameters& parameters) noexcept;

}  // namespace ecs
