// The working form of a map, made once when a map becomes active so that the tick is a straight run through memory, and
// the fixed-period loop of the unit over it: positions in, D/A counts out (thesis 5.3, compensation mode). No heap, no
// exception, no lock, no clock, bounded time; tests/core runs it with allocation forbidden. Storage is fixed (about 4.4
// MB): the owner puts it on the heap or in static memory before the first tick.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/address_map.hpp"
#include "core/fault.hpp"
#include "core/memory_image.hpp"
#include "core/rotary.hpp"
#include "core/thermal.hpp"

namespace ecs {

/// The six curves of one axis for one approach, side by side. Curve s is, in um or um/m of compensation,
///   value[i] + slope[i] · cell,  cell = clamp(position · cells_per_mm + offset, first, last),  i = ⌊cell⌋:
/// the end values hold beyond the ends. A curve without a table stays on cell 0, which is zero.
struct alignas(64) CurveSet {
  std::array<double, 6> cells_per_mm{};
  std::array<double, 6> offset{};
  std::array<double, 6> first{};
  std::array<double, 6> last{};
  std::array<std::uint32_t, 6> first_value{};  ///< index in the image of the value in cell `first`
};

/// How the rotations ε of one moving axis act on the tool, E += ε × L, as six products
///   ε_r · (gain · p_l + constant)   with r = B C C A A B and l = X X Y Y Z Z, for E_Z E_Y E_X E_Z E_Y E_X.
/// Sign, angular scale, measurement line and tool offset are inside; um per um/m, with p in mm.
struct alignas(16) AngularAction {
  std::array<double, 6> gain{};
  std::array<double, 6> constant{};
};

/// Of these products, how their constants follow from the tool offset:  constant = without_tool + per_mm · offset_l.
struct ToolAction {
  std::array<double, 6> without_tool{};
  std::array<double, 6> per_mm{};
};

/// Compensation of squareness, um per mm of the lever.
struct SquarenessAction {
  double x_by_y = 0.0;
  double x_by_z = 0.0;
  double y_by_z = 0.0;
};

/// One axis as the tick needs it.
struct AxisWorking {
  double mm_per_count = 0.001;
  double deadband_mm = 0.0;
};

/// From compensation to D/A counts, and back to the motion they bring about; absent axes have zeros.
struct alignas(16) OutputWorking {
  Lanes counts_per_um{};  ///< polarity inside
  Lanes least_counts{};   ///< −limit_counts
  Lanes limit_counts{};   ///< at most 32,767
  Lanes slew_counts{};    ///< per tick
  Lanes mm_per_output{};  ///< how far one D/A count moves the axis, in the end
  Lanes follow_part{};    ///< part of what is left of that way which the axis covers in one tick
  Lanes unsure_kept{};    ///< part of what is unsure of it that stays so after one tick
};

/// Index of an approach in per-approach tables.
[[nodiscard]] constexpr std::size_t side_of(Approach approach) noexcept {
  return approach == Approach::forward ? 1 : 0;
}

struct CompiledMap {
  static constexpr std::size_t kSides = 2;
  static constexpr std::size_t kCells = kMostValues + 1;  ///< cell 0 is zero

  PerAxis<std::array<CurveSet, kSides>> curves{};
  PerAxis<AngularAction> angular{};
  PerAxis<ToolAction> tool{};
  Vector3 tool_offset_mm{};  ///< that the map reckons with; change_tool() changes it
  SquarenessAction squareness{};
  SquarenessAction squareness_of_one{};  ///< of 1 um/m of each
  Vector3 squareness_um_per_m{};         ///< C0Y, B0Z, A0Z that `squareness` corrects; change_squareness() changes them
  PerAxis<AxisWorking> axes{};
  OutputWorking output{};
  double period_s = 0.001;
  ThermalWorking thermal{};  ///< without rows: none acts
  std::array<double, kCells> value{};
  std::array<double, kCells> slope{};
  RotaryWorking rotary{};  ///< arrangement none: no rotary axis
};

struct CompileVerdict {
  Fault fault = Fault::none;               ///< none, bad_parameters or map_not_for_parameters
  Component missing = Component::EXX;      ///< the first component that is needed and not there
  RotaryFault rotary = RotaryFault::none;  ///< why rotary axes of the map are not for the parameters
};

/// Builds the working form of a sound image (check_image found no fault) with the parameters it carries.
/// Refuses a map that lacks a component the scope and chain need and that is not declared zero; squareness comes from
/// the parameters. Refuses rotary axes as compile_rotary() does. On refusal `map` must not be used.
[[nodiscard]] CompileVerdict compile(const ImageView& image, CompiledMap& map) noexcept;

/// Adds rotary axes to a map that compile() has built from an image with these parameters. On refusal the map is as
/// before, without rotary axes.
[[nodiscard]] RotaryFault compile_rotary(const RotarySetup& machine, const UnitParameters& parameters,
                                         CompiledMap& map) noexcept;

/// What the loop remembers from tick to tick, and what can be read of it in between.
struct TickState {
  PerAxis<std::int64_t> datum_counts{};  ///< transducer counts at the datum
  Vector3 datum_mm{};                    ///< machine coordinate there
  Vector3 position_mm{};
  alignas(16) Lanes own_motion_mm{};   ///< part of the position that the unit's own output has brought about
  alignas(16) Lanes unsure_mm{};       ///< how far that may be wrong while the axis follows the output
  Vector3 extreme_mm{};                ///< furthest point that is sure in the present direction, own motion taken off
  PerAxis<Approach> approach{};        ///< forward or reverse, never unknown after start()
  Vector3 compensation_um{};           ///< what the model asks for, before scaling and limits
  alignas(16) Lanes output_counts{};   ///< D/A value, polarity and limits applied
  PerAxis<std::int32_t> dac_counts{};  ///< the same rounded: what leaves the unit
  PerAxis<bool> at_limit{};            ///< the size limit holds the value back
  std::uint64_t ticks = 0;
};

/// Sets reference positions, approaches and outputs before the first tick. The outputs begin at zero and slew up.
/// @param approach  direction in which each axis reached its datum
void start(TickState& state, const PerAxis<std::int64_t>& counts, const Vector3& position_mm,
           const PerAxis<Approach>& approach) noexcept;

/// One period. Any counts are accepted; the caller watches for jumps and lost transducers.
/// The transducers see what the unit adds: an axis at rest while another moves drifts by its own compensation. The
/// approach is therefore sensed on the position less the motion that the output has brought about, which follows the
/// output as the CNC's position loop does (first order, gain Kv); else an axis at rest would seem to turn round. No
/// drive follows exactly so: what the output has lately changed is unsure, until the loop, at a quarter of that gain,
/// has followed. Without this an axis at rest whose two approaches differ would go to and fro between them.
void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts) noexcept;
/// The same with what the slow loop (thermal.hpp) has come to: its temperatures, at the position of this period.
void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
          const ThermalPolynomial& thermal) noexcept;

/// Sets the rotary axes before the first tick. @pre the map has rotary axes
/// @param counts, position_deg, approach  by place (RotaryWorking)
void start_rotary(const RotaryWorking& working, RotaryTickState& state, const PerRotary<std::int64_t>& counts,
                  const PerRotary<double>& position_deg, const PerRotary<Approach>& approach) noexcept;
/// One period with rotary axes. @pre the map has rotary axes  @param rotary_counts  by place
void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
          const ThermalPolynomial& thermal, RotaryTickState& rotary,
          const PerRotary<std::int64_t>& rotary_counts) noexcept;
/// Where a head turns the tool, thermal rows act at its tip: after begin_thermal() and each step_thermal().
void follow_thermal(const CompiledMap& map, const ThermalState& thermal, RotaryTickState& rotary) noexcept;
/// Angle at the last tick, 0 … 360 deg.
[[nodiscard]] double rotary_position_deg(const RotaryWorking& working, const RotaryTickState& state,
                                         std::size_t place) noexcept;
/// How the axis with this letter came there. @pre the map has it
[[nodiscard]] Approach rotary_approach(const RotaryWorking& working, const RotaryTickState& state,
                                       char letter) noexcept;
/// What the errors of the rotary axes add to X, Y, Z at the last tick [um]; without the rotations of linear axes and
/// thermal rows, which act at a tool that a head turns. @pre the map has rotary axes
[[nodiscard]] Vector3 rotary_compensation_um(const CompiledMap& map, const TickState& state,
                                             const RotaryTickState& rotary) noexcept;

/// What a tool offset does at the place of the last tick: um of compensation along X, Y, Z for each mm along x, y, z.
[[nodiscard]] PerAxis<Vector3> tool_effect_um_per_mm(const CompiledMap& map, const TickState& state,
                                                     const ThermalState& thermal) noexcept;
/// The same with rotary axes at the angles of the last tick; x, y, z are those of the tool at angles of 0.
[[nodiscard]] PerAxis<Vector3> tool_effect_um_per_mm(const CompiledMap& map, const TickState& state,
                                                     const ThermalState& thermal,
                                                     const RotaryTickState& rotary) noexcept;

/// What bending of the head adds at the angles of the last tick: um of compensation along X, Y, Z for each mm of length
/// of the tool.
[[nodiscard]] Vector3 tool_bend_um_per_mm(const CompiledMap& map, const RotaryTickState& rotary) noexcept;

/// Takes the levers of every rotation, of the map and of its thermal rows, to another tool offset, between two ticks.
/// No axis is corrected by more than `most_um` more or less than before at the place of the last tick.
/// @pre            the map was compiled with a tool range or offset: without one, components that only a tool levers
/// are
///                 not in it (in_range() of tools.hpp refuses such a tool)
/// @param most_um  infinity: at once
/// @return         that offset is reached
bool change_tool(CompiledMap& map, const TickState& state, ThermalState& thermal, const Vector3& offset_mm,
                 double most_um) noexcept;
/// The same with rotary axes at the angles of the last tick. @pre the map has rotary axes
bool change_tool(CompiledMap& map, const TickState& state, ThermalState& thermal, RotaryTickState& rotary,
                 const Vector3& offset_mm, double most_um) noexcept;

/// Corrects other squareness errors C0Y, B0Z, A0Z from now on, between two ticks, with the limit of change_tool().
/// Those that scope and axes do not contain stay without effect.
bool change_squareness(CompiledMap& map, const TickState& state, const Vector3& um_per_m, double most_um) noexcept;

/// Address pointer of one curve ("last geometric error values selected", thesis 5.3).
struct SelectedValue {
  std::uint32_t place = 0;        ///< in its table, from 0; between two values the lower one
  std::uint32_t image_index = 0;  ///< for ImageView::value_offset()
  friend bool operator==(const SelectedValue&, const SelectedValue&) = default;
};
/// What the last tick selected; nothing for a curve that the map does not hold or the parameters do not use.
[[nodiscard]] std::optional<SelectedValue> selected_value(const CompiledMap& map, const TickState& state, Axis moving,
                                                          Sense sense) noexcept;

/// Direction after a move to `position_mm`: it turns only after travel back beyond the deadband (thesis 5.3,
/// "minimum distance to qualify as move"). `extreme_mm` follows.
/// @param unsure_mm  the position may be wrong by this much, either way
[[nodiscard]] inline Approach sensed_approach(Approach before, double position_mm, double deadband_mm,
                                              double& extreme_mm, double unsure_mm = 0.0) noexcept {
  const bool forward = before == Approach::forward;
  const double onward_mm = forward ? position_mm - extreme_mm : extreme_mm - position_mm;
  if (onward_mm >= unsure_mm) {
    extreme_mm = forward ? position_mm - unsure_mm : position_mm + unsure_mm;
  } else if (-onward_mm > deadband_mm + unsure_mm) {
    extreme_mm = forward ? position_mm + unsure_mm : position_mm - unsure_mm;
    return before == Approach::forward ? Approach::reverse : Approach::forward;
  }
  return before;
}

/// Model value at a pose without state: what tick() would ask for. For tests, displays and predictions.
[[nodiscard]] Vector3 compensation_um_at(const CompiledMap& map, const Vector3& position_mm,
                                         const PerAxis<Approach>& approach) noexcept;

}  // namespace ecs
