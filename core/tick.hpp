// The fixed-period loop of the unit: positions in, D/A counts out (thesis 5.3, compensation mode).
// No heap, no exception, no lock, no clock, bounded time; tests/core runs it with allocation forbidden.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/compiled_map.hpp"

namespace ecs {

/// What the loop remembers from tick to tick, and what can be read of it in between.
struct TickState {
  PerAxis<std::int64_t> datum_counts{};  ///< transducer counts at the datum
  Vector3 datum_mm{};                    ///< machine coordinate there
  Vector3 position_mm{};
  alignas(16) Lanes own_motion_mm{};   ///< part of the position that the unit's own output has brought about
  Vector3 extreme_mm{};                ///< furthest point in the present direction of motion, own motion taken off
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
/// output as the CNC's position loop does (first order, gain Kv); else an axis at rest would seem to turn round.
void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts) noexcept;

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
[[nodiscard]] inline Approach sensed_approach(Approach before, double position_mm, double deadband_mm,
                                              double& extreme_mm) noexcept {
  const double onward_mm = (position_mm - extreme_mm) * static_cast<double>(static_cast<std::int8_t>(before));
  if (onward_mm >= 0.0) {
    extreme_mm = position_mm;
  } else if (-onward_mm > deadband_mm) {
    extreme_mm = position_mm;
    return before == Approach::forward ? Approach::reverse : Approach::forward;
  }
  return before;
}

/// Model value at a pose without state: what tick() would ask for. For tests, displays and predictions.
[[nodiscard]] Vector3 compensation_um_at(const CompiledMap& map, const Vector3& position_mm,
                                         const PerAxis<Approach>& approach) noexcept;

}  // namespace ecs
