#include "core/tick.hpp"

#include <algorithm>
#include <cmath>

namespace ecs {
namespace {

using Curves = std::array<std::array<double, 6>, kAxes>;  // [axis][sense]
using Places = std::array<std::array<std::int32_t, 6>, kAxes>;

/// The six curves of one axis at its position.
inline void look_up(const CompiledMap& map, std::size_t axis, std::size_t side, double position_mm,
                    std::array<double, 6>& value, std::array<std::int32_t, 6>& cell) noexcept {
  const auto& scale = map.place_per_mm[axis][side];
  const auto& offset = map.place_offset[axis][side];
  const auto& last = map.last_place[axis][side];
  const auto& lookup = map.lookup[axis][side];
  std::array<double, 6> place;
  for (std::size_t s = 0; s < 6; ++s) {
    const double inside = position_mm * scale[s] + offset[s];
    const double above = inside > 0.0 ? inside : 0.0;
    place[s] = above < last[s] ? above : last[s];
    cell[s] = static_cast<std::int32_t>(place[s]);
  }
  for (std::size_t s = 0; s < 6; ++s) {
    const Cell& c = map.cells[lookup[s].first_cell + static_cast<std::uint32_t>(cell[s])];
    value[s] = c.value + c.slope * place[s];
  }
}

/// Rows of the term table in their compiled order (thesis 4.3).
inline Vector3 combine(const CompiledMap& map, const Curves& v, const Vector3& p) noexcept {
  Vector3 sum{};
  for (std::size_t b = 0; b < kAxes; ++b) {
    const AngularAction& act = map.angular[b];
    const double lx = act.lever_gain[0] * p[0] + act.lever_constant_m[0];
    const double ly = act.lever_gain[1] * p[1] + act.lever_constant_m[1];
    const double lz = act.lever_gain[2] * p[2] + act.lever_constant_m[2];
    const auto& [ex, ey, ez, ea, eb, ec] = v[b];
    const auto& w = act.weight;
    sum[0] += map.translation_weight[0][b] * ex + w[0] * eb * lz + w[1] * ec * ly;
    sum[1] += map.translation_weight[1][b] * ey + w[2] * ec * lx + w[3] * ea * lz;
    sum[2] += map.translation_weight[2][b] * ez + w[4] * ea * ly + w[5] * eb * lx;
  }
  for (std::size_t o = 0; o < kAxes; ++o)
    for (std::size_t l = 0; l < kAxes; ++l) sum[o] += map.squareness_um_per_mm[o][l] * p[l];
  return sum;
}

/// Scaling, size limit, slew limit, rounding.
inline void put_out(const AxisWorking& axis, double compensation_um, TickState& state, std::size_t a) noexcept {
  const double asked = compensation_um * axis.counts_per_um;
  const double sized = std::min(std::max(asked, -axis.limit_counts), axis.limit_counts);
  state.at_limit[a] = sized != asked;
  const double before = state.output_counts[a];
  const double output = std::min(std::max(sized, before - axis.slew_counts), before + axis.slew_counts);
  state.output_counts[a] = output;
  state.dac_counts[a] = static_cast<std::int32_t>(output + std::copysign(0.5, output));
}

}  // namespace

void start(TickState& state, const PerAxis<std::int64_t>& counts, const Vector3& position_mm,
           const PerAxis<Approach>& approach) noexcept {
  state = TickState{};
  state.datum_counts = counts;
  state.datum_mm = position_mm;
  state.position_mm = position_mm;
  state.extreme_mm = position_mm;
  for (std::size_t a = 0; a < kAxes; ++a)
    state.approach[a] = approach[a] == Approach::unknown ? Approach::forward : approach[a];
}

void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts) noexcept {
  Curves values;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const AxisWorking& axis = map.axes[a];
    const double position_mm =
        state.datum_mm[a] + static_cast<double>(counts[a] - state.datum_counts[a]) * axis.mm_per_count;
    state.position_mm[a] = position_mm;
    state.approach[a] = sensed_approach(state.approach[a], position_mm, axis.deadband_mm, state.extreme_mm[a]);
    look_up(map, a, side_of(state.approach[a]), position_mm, values[a], state.cell[a]);
  }
  state.compensation_um = combine(map, values, state.position_mm);
  for (std::size_t a = 0; a < kAxes; ++a) put_out(map.axes[a], state.compensation_um[a], state, a);
  ++state.ticks;
}

Vector3 compensation_um_at(const CompiledMap& map, const Vector3& position_mm,
                           const PerAxis<Approach>& approach) noexcept {
  Curves values;
  Places cells;
  for (std::size_t a = 0; a < kAxes; ++a) look_up(map, a, side_of(approach[a]), position_mm[a], values[a], cells[a]);
  return combine(map, values, position_mm);
}

}  // namespace ecs
