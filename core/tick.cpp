#include "core/tick.hpp"

#include <cmath>
#include <memory>

#include "core/pair.hpp"

namespace ecs {
namespace {

using Six = std::array<double, 6>;

/// The curves of one axis at its position, in the order of the senses.
struct CurveValues {
  Pair xy;
  Pair za;
  Pair bc;
};

/// Rotations as a cross product needs them: B C, C A, A B.
using Turns = std::array<Pair, kAxes>;

inline Turns turns_of(Pair za, Pair bc) noexcept { return {bc, highs(bc, za), Pair{za[1], bc[0]}}; }

/// A loop of plain arithmetic, so that the compiler makes vector instructions of it.
inline Six cells_at(const CurveSet& curves, double position_mm) noexcept {
  const double* const cells_per_mm = std::assume_aligned<16>(curves.cells_per_mm.data());
  const double* const offset = std::assume_aligned<16>(curves.offset.data());
  const double* const first = std::assume_aligned<16>(curves.first.data());
  const double* const last = std::assume_aligned<16>(curves.last.data());
  Six cell;
  for (std::size_t s = 0; s < 6; ++s) {
    const double anywhere = position_mm * cells_per_mm[s] + offset[s];
    const double above = anywhere > first[s] ? anywhere : first[s];
    cell[s] = above < last[s] ? above : last[s];
  }
  return cell;
}

inline CurveValues look_up(const CompiledMap& map, const CurveSet& curves, double position_mm) noexcept {
  const Six cell = cells_at(curves, position_mm);
  const auto values = [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(static_cast<std::int64_t>(cell[s]));
    const auto j = static_cast<std::size_t>(static_cast<std::int64_t>(cell[s + 1]));
    return Pair{map.value[i], map.value[j]} + Pair{map.slope[i], map.slope[j]} * Pair{cell[s], cell[s + 1]};
  };
  return {values(0), values(2), values(4)};
}

/// Along X, Y and Z.
struct Compensation {
  Pair xy_um;
  double z_um = 0.0;
};

/// The rows of the term table in their compiled order (thesis 4.3).
inline Compensation combine(const CompiledMap& map, const PerAxis<CurveValues>& values, const Vector3& p) noexcept {
  std::array<Turns, kAxes> turned;  // by moving axis: um along Z Y, X Z, Y X
  for (std::size_t a = 0; a < kAxes; ++a) {
    const AngularAction& action = map.angular[a];
    const Turns turns = turns_of(values[a].za, values[a].bc);
    for (std::size_t l = 0; l < kAxes; ++l)
      turned[a][l] = turns[l] * (pair_at(&action.gain[2 * l]) * twice(p[l]) + pair_at(&action.constant[2 * l]));
  }
  const auto sum = [&](std::size_t l) { return turned[0][l] + turned[1][l] + turned[2][l]; };
  const Pair zy = sum(0), xz = sum(1), yx = sum(2);
  const Pair moved = values[0].xy + values[1].xy + values[2].xy;
  const double moved_z = (values[0].za + values[1].za + values[2].za)[0];
  const SquarenessAction& square = map.squareness;
  return {moved + Pair{xz[0], zy[1]} + Pair{yx[1], yx[0]} + Pair{square.x_by_y * p[1], 0.0} +
              Pair{square.x_by_z, square.y_by_z} * twice(p[2]),
          moved_z + zy[0] + xz[1]};
}

/// A counter that wraps round is no overflow: the difference does not see it.
inline double travelled_counts(std::int64_t counts, std::int64_t datum_counts) noexcept {
  return static_cast<double>(
      static_cast<std::int64_t>(static_cast<std::uint64_t>(counts) - static_cast<std::uint64_t>(datum_counts)));
}

/// Nearest integer; @pre |value| <= 32,767.5
inline std::int32_t rounded(double value) noexcept { return static_cast<std::int32_t>(value + 32768.5) - 32768; }

/// Scaling, size limit, slew limit, rounding; and how the axes follow. Plain arithmetic in lanes, as above.
inline void put_out(const OutputWorking& to, TickState& state) noexcept {
  const double* const counts_per_um = std::assume_aligned<16>(to.counts_per_um.data());
  const double* const least_counts = std::assume_aligned<16>(to.least_counts.data());
  const double* const limit_counts = std::assume_aligned<16>(to.limit_counts.data());
  const double* const slew_counts = std::assume_aligned<16>(to.slew_counts.data());
  const double* const mm_per_output = std::assume_aligned<16>(to.mm_per_output.data());
  const double* const follow_part = std::assume_aligned<16>(to.follow_part.data());
  const double* const unsure_kept = std::assume_aligned<16>(to.unsure_kept.data());
  const Lanes before = state.output_counts;
  const Lanes own_mm = state.own_motion_mm, unsure_mm = state.unsure_mm;
  const Pair asked_xy = Pair{state.compensation_um[0], state.compensation_um[1]} * pair_at(counts_per_um);
  const Pair asked_z = Pair{state.compensation_um[2], 0.0} * pair_at(counts_per_um + 2);
  const Lanes asked{asked_xy[0], asked_xy[1], asked_z[0], asked_z[1]};
  Lanes output, followed, unsure;
  for (std::size_t a = 0; a < 4; ++a) {
    const double least = before[a] - slew_counts[a];
    const double most = before[a] + slew_counts[a];
    const double above = asked[a] > least_counts[a] ? asked[a] : least_counts[a];
    const double sized = above < limit_counts[a] ? above : limit_counts[a];
    const double rising = sized > least ? sized : least;
    output[a] = rising < most ? rising : most;
    followed[a] = own_mm[a] + (output[a] * mm_per_output[a] - own_mm[a]) * follow_part[a];
    unsure[a] = unsure_mm[a] * unsure_kept[a] + std::abs((output[a] - before[a]) * mm_per_output[a]);
  }
  state.output_counts = output;
  state.own_motion_mm = followed;
  state.unsure_mm = unsure;
  for (std::size_t a = 0; a < kAxes; ++a) {
    state.at_limit[a] = std::abs(asked[a]) > to.limit_counts[a];
    state.dac_counts[a] = rounded(output[a]);
  }
}

/// Position and approach of one axis, and its curves there.
inline CurveValues read_axis(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
                             std::size_t a) noexcept {
  const AxisWorking& axis = map.axes[a];
  const double position_mm = state.datum_mm[a] + travelled_counts(counts[a], state.datum_counts[a]) * axis.mm_per_count;
  state.position_mm[a] = position_mm;
  state.approach[a] = sensed_approach(state.approach[a], position_mm - state.own_motion_mm[a], axis.deadband_mm,
                                      state.extreme_mm[a], state.unsure_mm[a]);
  return look_up(map, map.curves[a][side_of(state.approach[a])], position_mm);
}

inline PerAxis<CurveValues> read_axes(const CompiledMap& map, TickState& state,
                                      const PerAxis<std::int64_t>& counts) noexcept {
  return {read_axis(map, state, counts, 0), read_axis(map, state, counts, 1), read_axis(map, state, counts, 2)};
}

inline Compensation compensated(const CompiledMap& map, TickState& state,
                                const PerAxis<std::int64_t>& counts) noexcept {
  return combine(map, read_axes(map, state, counts), state.position_mm);
}

/// Translation, um, and rotation, um for each mm of an arm, side by side along X, Y, Z.
using Twist = std::array<Pair, kAxes>;

/// Curves of a rotary axis, and cosine and sine.
struct RotaryValues {
  Twist twist;
  Pair turned;
};

inline RotaryValues values_at(const RotaryAxisWorking& axis, std::uint64_t turn, std::uint64_t counts_rise) noexcept {
  const std::uint64_t cells = (turn >> 32) * axis.cells;
  const RotaryCell& cell = axis.cell[cells >> 32][counts_rise];
  const Pair part = twice(static_cast<double>(static_cast<std::int64_t>(cells & 0xFFFFFFFFu)));
  const auto value = [&](std::size_t k) { return pair_at(&cell.value[2 * k]) + pair_at(&cell.slope[2 * k]) * part; };
  return {{value(0), value(1), value(2)}, value(3)};
}

/// Of both axes at the angles of the last tick.
inline PerRotary<RotaryValues> values_at(const RotaryWorking& working, const RotaryTickState& state) noexcept {
  return {values_at(working.axes[0], state.turn[0], state.counts_rise[0]),
          values_at(working.axes[1], state.turn[1], state.counts_rise[1])};
}

/// Angle and approach of the rotary axis at a place, and its values there.
inline RotaryValues read_rotary(const RotaryAxisWorking& axis, RotaryTickState& state, std::int64_t counts,
                                std::size_t place) noexcept {
  const auto now = static_cast<std::uint64_t>(counts);
  const std::int64_t sense = 2 * static_cast<std::int64_t>(state.counts_rise[place]) - 1;
  const std::int64_t onward =
      static_cast<std::int64_t>(now - static_cast<std::uint64_t>(state.extreme_counts[place])) * sense;
  if (onward >= 0) {
    state.extreme_counts[place] = counts;
  } else if (-onward > axis.deadband_counts) {
    state.extreme_counts[place] = counts;
    state.counts_rise[place] ^= 1;
  }
  state.turn[place] = state.turn_at_0[place] + now * axis.turn_per_count;
  return values_at(axis, state.turn[place], state.counts_rise[place]);
}

/// v turned about n.
template <class Number>
inline std::array<Number, kAxes> turned_about(const Vector3& n, const std::array<Number, kAxes>& v, Number c,
                                              Number s) noexcept {
  const Number along = (n[0] * v[0] + n[1] * v[1] + n[2] * v[2]) * (1.0 - c);
  return {c * v[0] + s * (n[1] * v[2] - n[2] * v[1]) + along * n[0],
          c * v[1] + s * (n[2] * v[0] - n[0] * v[2]) + along * n[1],
          c * v[2] + s * (n[0] * v[1] - n[1] * v[0]) + along * n[2]};
}

/// v turned about the inner axis, in the sense of Q.
template <std::size_t direction>
inline Twist turned(const RotaryWorking& working, const Twist& v, Pair c, Pair s) noexcept {
  if constexpr (direction < kAxes) {
    constexpr std::size_t i = (direction + 1) % kAxes, j = (direction + 2) % kAxes;
    Twist out = v;
    out[i] = c * v[i] - s * v[j];
    out[j] = s * v[i] + c * v[j];
    return out;
  } else {
    return turned_about(working.inner_axis, v, c, s);
  }
}

/// The same of an arm. @param turn  cosine and sine
template <std::size_t direction>
inline Vector3 turned_arm(const RotaryWorking& working, const Vector3& v, Pair turn) noexcept {
  if constexpr (direction < kAxes) {
    constexpr std::size_t i = (direction + 1) % kAxes, j = (direction + 2) % kAxes;
    const Pair ij = twice(v[i]) * turn + twice(v[j]) * Pair{-turn[1], turn[0]};
    Vector3 out = v;
    out[i] = ij[0];
    out[j] = ij[1];
    return out;
  } else {
    return turned_about(working.inner_axis, v, turn[0], turn[1]);
  }
}

/// X and Y, Z and 0 at an angle. @param turn  its cosine and sine
inline std::array<Pair, 2> at_turn(const TurnedLanes& of, Pair turn) noexcept {
  const Pair c = twice(turn[0]), s = twice(turn[1]);
  const auto at = [&](std::size_t k) { return pair_at(&of[0][k]) + c * pair_at(&of[1][k]) + s * pair_at(&of[2][k]); };
  return {at(0), at(2)};
}

/// Both axes of one side, as the inner one carries them.
template <std::size_t direction>
inline Twist both(const RotaryWorking& working, const PerRotary<RotaryValues>& values) noexcept {
  const Pair turn = values[0].turned;
  const Twist inner = values[0].twist;
  const Twist outer = turned<direction>(working, values[1].twist, twice(turn[0]), twice(turn[1]));
  return {inner[0] + outer[0], inner[1] + outer[1], inner[2] + outer[2]};
}

/// @param za, bc  rotations to add, as in CurveValues
inline Turns turns_of(const Twist& twist, Pair za, Pair bc) noexcept {
  return turns_of(twist[0] + za, highs(twist[1], twist[2]) + bc);
}
inline Turns turns_of(const Twist& twist) noexcept { return turns_of(twist[0], highs(twist[1], twist[2])); }

inline Compensation plus_cross(const Compensation& sum, const Turns& turns, const Vector3& arm_mm) noexcept {
  const Pair zx{arm_mm[2], arm_mm[0]}, yz{arm_mm[1], arm_mm[2]}, yx{arm_mm[1], arm_mm[0]};
  const Pair z = turns[2] * yx;
  return {sum.xy_um + (turns[0] * zx - turns[1] * yz), sum.z_um + (z[0] - z[1])};
}
inline Compensation shift_of(const Twist& twist) noexcept { return {lows(twist[0], twist[1]), twist[2][0]}; }

/// Arm of the tool with the axis at place 1 turned.
inline Vector3 arm_of_tool_mm(const RotaryWorking& working, Pair turn) noexcept {
  const auto [xy_mm, z_mm] = at_turn(working.arm_mm, turn);
  return {xy_mm[0], xy_mm[1], z_mm[0]};
}

/// With the bending that a head turns.
inline Twist bent(const RotaryWorking& working, const RotaryValues& head) noexcept {
  const auto [xy_um, z_um] = at_turn(working.tool_bend_um, head.turned);
  const Pair none{};
  return {head.twist[0] + lows(xy_um, none), head.twist[1] + highs(xy_um, none), head.twist[2] + z_um};
}

inline Vector3 plus(const Vector3& a, const Vector3& b) noexcept { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

/// Rotations of a head and of the linear axes, which act at a tool that the head turns.
inline Turns turns_at_tool(const RotaryWorking& working, const RotaryTickState& state,
                           const PerAxis<CurveValues>& linear, const Twist& head) noexcept {
  const Pair scale = pair_at(working.um_per_mm.data());
  return turns_of(head, scale * (linear[0].za + linear[1].za + linear[2].za + pair_at(&state.thermal_turn[0])),
                  scale * (linear[0].bc + linear[1].bc + linear[2].bc + pair_at(&state.thermal_turn[2])));
}

/// What bends beneath the tilting axis of a head; beside a table all of it is Bends::tool.
enum class Bends : std::uint8_t { nothing, machine, tool, both };

/// What the rotary axes add.
template <RotaryWorking::Arrangement arrangement, std::size_t direction, Bends bends>
inline Compensation rotary_um(const RotaryWorking& working, const RotaryTickState& state, const Vector3& position_mm,
                              const PerAxis<CurveValues>& linear, const PerRotary<RotaryValues>& values) noexcept {
  using enum RotaryWorking::Arrangement;
  if constexpr (arrangement == tables) {
    const Twist twist = both<direction>(working, values);
    const Lanes& arm = working.arm_mm[0];
    return plus_cross(shift_of(twist), turns_of(twist),
                      {position_mm[0] + arm[0], position_mm[1] + arm[1], position_mm[2] + arm[2]});
  } else if constexpr (arrangement == heads) {
    const Pair tilt = values[1].turned;
    const Twist twist = both<direction>(
        working, {values[0], {bends >= Bends::tool ? bent(working, values[1]) : values[1].twist, tilt}});
    const Vector3 arm_mm = turned_arm<direction>(working, arm_of_tool_mm(working, tilt), values[0].turned);
    Compensation shift_um = shift_of(twist);
    if constexpr (bends == Bends::machine || bends == Bends::both) {
      const auto [xy_um, z_um] = at_turn(working.machine_bend_um, tilt);
      shift_um = {shift_um.xy_um + xy_um, shift_um.z_um + z_um[0]};
    }
    return plus_cross(shift_um, turns_at_tool(working, state, linear, twist), arm_mm);
  } else {
    const Twist& table = values[0].twist;
    const Twist head = bends >= Bends::tool ? bent(working, values[1]) : values[1].twist;
    const Vector3 arm_mm = arm_of_tool_mm(working, values[1].turned);
    const Twist twist{table[0] + head[0], table[1] + head[1], table[2] + head[2]};
    return plus_cross(plus_cross(shift_of(twist), turns_of(table), plus(position_mm, working.table_arm_mm)),
                      turns_at_tool(working, state, linear, twist), arm_mm);
  }
}

/// A period of one arrangement and direction of the inner axis. A function for each, so that its numbers stay in
/// registers.
template <RotaryWorking::Arrangement arrangement, std::size_t direction, Bends bends>
[[gnu::flatten]] void tick_on_way(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
                                  const ThermalPolynomial& thermal, RotaryTickState& rotary,
                                  const PerRotary<std::int64_t>& rotary_counts) noexcept {
  const PerAxis<CurveValues> values = read_axes(map, state, counts);
  const Compensation linear_um = combine(map, values, state.position_mm);
  const Compensation turned_um =
      rotary_um<arrangement, direction, bends>(map.rotary, rotary, state.position_mm, values,
                                               {read_rotary(map.rotary.axes[0], rotary, rotary_counts[0], 0),
                                                read_rotary(map.rotary.axes[1], rotary, rotary_counts[1], 1)});
  const Lanes warm_um = value_um(thermal, state.position_mm);
  const Pair xy_um = linear_um.xy_um + turned_um.xy_um + Pair{warm_um[0], warm_um[1]};
  state.compensation_um = {xy_um[0], xy_um[1], linear_um.z_um + turned_um.z_um + warm_um[2]};
  put_out(map.output, state);
  ++state.ticks;
}

using TickOnWay = decltype(&tick_on_way<RotaryWorking::Arrangement::tables, 0, Bends::nothing>);

/// Of X, Y, Z and oblique.
template <RotaryWorking::Arrangement arrangement, Bends bends>
constexpr std::array<TickOnWay, 4> kDirections{&tick_on_way<arrangement, 0, bends>, &tick_on_way<arrangement, 1, bends>,
                                               &tick_on_way<arrangement, 2, bends>,
                                               &tick_on_way<arrangement, RotaryWorking::kOblique, bends>};

/// By RotaryWorking::way.
constexpr std::array kWays = [] {
  using enum RotaryWorking::Arrangement;
  std::array<TickOnWay, RotaryWorking::kWays> ways{};
  std::size_t next = 0;
  for (const auto& directions :
       {kDirections<tables, Bends::nothing>, kDirections<heads, Bends::nothing>, kDirections<heads, Bends::machine>,
        kDirections<heads, Bends::tool>, kDirections<heads, Bends::both>})
    for (const TickOnWay way : directions) ways[next++] = way;
  ways[next++] = &tick_on_way<table_and_head, 0, Bends::nothing>;
  ways[next] = &tick_on_way<table_and_head, 0, Bends::tool>;
  return ways;
}();

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

[[gnu::flatten]] void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts) noexcept {
  const Compensation asked = compensated(map, state, counts);
  state.compensation_um = {asked.xy_um[0], asked.xy_um[1], asked.z_um};
  put_out(map.output, state);
  ++state.ticks;
}

[[gnu::flatten]] void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
                           const ThermalPolynomial& thermal) noexcept {
  const Compensation asked = compensated(map, state, counts);
  const Lanes warm_um = value_um(thermal, state.position_mm);
  state.compensation_um = {asked.xy_um[0] + warm_um[0], asked.xy_um[1] + warm_um[1], asked.z_um + warm_um[2]};
  put_out(map.output, state);
  ++state.ticks;
}

void start_rotary(const RotaryWorking& working, RotaryTickState& state, const PerRotary<std::int64_t>& counts,
                  const PerRotary<double>& position_deg, const PerRotary<Approach>& approach) noexcept {
  state = RotaryTickState{};
  for (std::size_t p = 0; p < kRotaryInputs; ++p) {
    const RotaryAxisWorking& axis = working.axes[p];
    if (axis.letter == '\0') continue;
    state.turn[p] = turn_of(position_deg[p]) - axis.start;
    state.turn_at_0[p] = state.turn[p] - static_cast<std::uint64_t>(counts[p]) * axis.turn_per_count;
    state.extreme_counts[p] = counts[p];
    const bool backwards = static_cast<std::int64_t>(axis.turn_per_count) < 0;
    state.counts_rise[p] = (approach[p] == Approach::reverse) == backwards ? 1 : 0;
  }
}

double rotary_position_deg(const RotaryWorking& working, const RotaryTickState& state, std::size_t place) noexcept {
  return static_cast<double>(state.turn[place] + working.axes[place].start) * (360.0 * 0x1p-64);
}

Approach rotary_approach(const RotaryWorking& working, const RotaryTickState& state, char letter) noexcept {
  const std::size_t place = working.axes[0].letter == letter ? 0 : 1;
  const bool backwards = static_cast<std::int64_t>(working.axes[place].turn_per_count) < 0;
  return (state.counts_rise[place] == 1) == backwards ? Approach::reverse : Approach::forward;
}

Vector3 rotary_compensation_um(const CompiledMap& map, const TickState& state, const RotaryTickState& rotary) noexcept {
  using enum RotaryWorking::Arrangement;
  const RotaryWorking& working = map.rotary;
  const PerRotary<RotaryValues> values = values_at(working, rotary);
  const RotaryTickState alone;
  const auto added = [&](const auto& of_arrangement) {
    const Compensation um = of_arrangement(working, alone, state.position_mm, PerAxis<CurveValues>{}, values);
    return Vector3{um.xy_um[0], um.xy_um[1], um.z_um};
  };
  if (working.arrangement == tables) return added(rotary_um<tables, RotaryWorking::kOblique, Bends::nothing>);
  if (working.arrangement == heads) return added(rotary_um<heads, RotaryWorking::kOblique, Bends::both>);
  return added(rotary_um<table_and_head, RotaryWorking::kOblique, Bends::tool>);
}

void follow_thermal(const CompiledMap& map, const ThermalState& thermal, RotaryTickState& rotary) noexcept {
  if (!map.rotary.turns_tool() || map.rotary.um_per_mm[0] == 0.0) return;
  const PerAxis<Vector3> effect = thermal_tool_effect_um_per_mm(map.thermal, thermal);
  for (std::size_t about = 0; about < kAxes; ++about) {
    const std::size_t i = (about + 1) % kAxes, j = (about + 2) % kAxes;
    const double um_per_mm = effect[i][j] != 0.0 ? effect[i][j] : -effect[j][i];  // one of these axes may not exist
    rotary.thermal_turn[1 + about] = um_per_mm / map.rotary.um_per_mm[0];
  }
}

void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
          const ThermalPolynomial& thermal, RotaryTickState& rotary,
          const PerRotary<std::int64_t>& rotary_counts) noexcept {
  kWays[map.rotary.way](map, state, counts, thermal, rotary, rotary_counts);
}

Vector3 compensation_um_at(const CompiledMap& map, const Vector3& position_mm,
                           const PerAxis<Approach>& approach) noexcept {
  const auto values = [&](std::size_t a) { return look_up(map, map.curves[a][side_of(approach[a])], position_mm[a]); };
  const Compensation asked = combine(map, {values(0), values(1), values(2)}, position_mm);
  return {asked.xy_um[0], asked.xy_um[1], asked.z_um};
}

PerAxis<Vector3> tool_effect_um_per_mm(const CompiledMap& map, const TickState& state,
                                       const ThermalState& thermal) noexcept {
  PerAxis<Vector3> effect = thermal_tool_effect_um_per_mm(map.thermal, thermal);
  for (std::size_t a = 0; a < kAxes; ++a) {
    const CurveValues values = look_up(map, map.curves[a][side_of(state.approach[a])], state.position_mm[a]);
    const Turns turns = turns_of(values.za, values.bc);
    for (std::size_t k = 0; k < 6; ++k) {
      const std::size_t lever = k / 2, observed = (lever + (k % 2 == 0 ? 2 : 1)) % 3;
      effect[lever][observed] += turns[k / 2][k % 2] * map.tool[a].per_mm[k];
    }
  }
  return effect;
}

PerAxis<Vector3> tool_effect_um_per_mm(const CompiledMap& map, const TickState& state, const ThermalState& thermal,
                                       const RotaryTickState& rotary) noexcept {
  const RotaryWorking& working = map.rotary;
  const PerRotary<RotaryValues> values = values_at(working, rotary);
  const bool apart = working.arrangement == RotaryWorking::Arrangement::table_and_head;
  const Twist twist = both<RotaryWorking::kOblique>(working, values);
  const PerAxis<Vector3> unturned = tool_effect_um_per_mm(map, state, thermal);
  PerAxis<Vector3> effect{};
  for (std::size_t l = 0; l < kAxes; ++l) {
    Vector3 arm{};
    arm[l] = 1.0;
    if (working.turns_tool()) arm = turned_about(working.turned_about, arm, values[1].turned[0], values[1].turned[1]);
    if (working.arrangement == RotaryWorking::Arrangement::heads)
      arm = turned_about(working.inner_axis, arm, values[0].turned[0], values[0].turned[1]);
    for (std::size_t k = 0; k < kAxes; ++k) {
      const std::size_t i = (k + 1) % kAxes, j = (k + 2) % kAxes;
      const double turn = apart ? values[0].twist[k][1] + values[1].twist[k][1] : twist[k][1];
      for (std::size_t o = 0; o < kAxes; ++o) effect[l][o] += arm[k] * unturned[k][o];
      effect[l][j] += turn * arm[i];
      effect[l][i] -= turn * arm[j];
    }
  }
  return effect;
}

Vector3 tool_bend_um_per_mm(const CompiledMap& map, const RotaryTickState& rotary) noexcept {
  const RotaryWorking& working = map.rotary;
  const auto [inner, head] = values_at(working, rotary);
  const std::array<double, 6>& of_tool = working.bending.of_tool;
  Vector3 um{};
  for (std::size_t d = 0; d < kAxes; ++d)
    um[d] = -1e-3 * (of_tool[d] * head.turned[1] + of_tool[kAxes + d] * (1.0 - head.turned[0]));
  return working.arrangement == RotaryWorking::Arrangement::heads
             ? turned_about(working.inner_axis, um, inner.turned[0], inner.turned[1])
             : um;
}

std::optional<SelectedValue> selected_value(const CompiledMap& map, const TickState& state, Axis moving,
                                            Sense sense) noexcept {
  const std::size_t a = index_of(moving);
  const auto s = static_cast<std::size_t>(sense);
  const CurveSet& curves = map.curves[a][side_of(state.approach[a])];
  if (curves.first[s] == 0.0) return std::nullopt;
  const auto place = static_cast<std::uint32_t>(cells_at(curves, state.position_mm[a])[s] - curves.first[s]);
  return SelectedValue{place, curves.first_value[s] + place};
}

}  // namespace ecs
