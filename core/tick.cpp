#include "core/tick.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace ecs {
namespace {

/// No position loop takes longer to follow the unit than one of this part of the gain that its parameters state. A
/// choice: with less an axis takes longer to be seen to turn while the compensation changes fast.
constexpr double kSlowestFollowing = 0.25;

std::size_t sense_index(Component c) noexcept { return static_cast<std::size_t>(sense_of(c)); }

/// Cells of one table: linear pieces, or steps of half an increment either side of each value.
void fill_cells(const ImageView& image, const TableEntry& entry, Interpolation interpolation, std::uint32_t first_cell,
                CompiledMap& map) noexcept {
  for (std::uint32_t k = 0; k < entry.count; ++k) {
    const double here = image.value_counts(entry.first_value + k) * entry.resolution;
    const bool slopes = interpolation == Interpolation::linear && k + 1 < entry.count;
    const double next = slopes ? image.value_counts(entry.first_value + k + 1) * entry.resolution : here;
    map.slope[first_cell + k] = next - here;
    map.value[first_cell + k] = here - (next - here) * (first_cell + k);
  }
}

void place_table(const TableEntry& entry, Interpolation interpolation, std::uint32_t first_cell,
                 CurveSet& curves) noexcept {
  const std::size_t s = sense_index(entry.component);
  const double half_step = interpolation == Interpolation::nearest ? 0.5 : 0.0;
  curves.cells_per_mm[s] = 1.0 / entry.increment_mm;
  curves.offset[s] = first_cell + half_step - entry.start_mm / entry.increment_mm;
  curves.first[s] = first_cell;
  curves.last[s] = first_cell + (entry.count - 1);
  curves.first_value[s] = entry.first_value;
}

/// Only the curves that a term reads; the others stay on the zero cell.
void compile_tables(const ImageView& image, Interpolation interpolation, const ComponentSet& used,
                    CompiledMap& map) noexcept {
  std::uint32_t next_cell = 1;
  for (std::uint32_t i = 0; i < image.table_count(); ++i) {
    const TableEntry entry = image.entry(i);
    if (entry.declared_zero || !used.contains(entry.component)) continue;
    fill_cells(image, entry, interpolation, next_cell, map);
    auto& sides = map.curves[index_of(moving_axis(entry.component))];
    for (const Approach approach : {Approach::forward, Approach::reverse})
      if (entry.approach == approach || entry.approach == Approach::unknown)
        place_table(entry, interpolation, next_cell, sides[side_of(approach)]);
    next_cell += entry.count;
  }
}

void add_squareness(const Term& term, SquarenessAction& of_one) noexcept {
  // parameters hold the error, the unit adds compensation
  const double per_mm = -term.sign / 1000.0;
  if (term.component == Component::C0Y) of_one.x_by_y = per_mm;
  if (term.component == Component::B0Z) of_one.x_by_z = per_mm;
  if (term.component == Component::A0Z) of_one.y_by_z = per_mm;
}

void set_squareness(CompiledMap& map, const Vector3& um_per_m) noexcept {
  const SquarenessAction& of_one = map.squareness_of_one;
  map.squareness_um_per_m = um_per_m;
  map.squareness = {of_one.x_by_y * um_per_m[0], of_one.x_by_z * um_per_m[1], of_one.y_by_z * um_per_m[2]};
}

/// The share of a change that corrects no axis by more than `most_um` more or less.
double share_within(const Vector3& change_um, double most_um) noexcept {
  double largest_um = 0.0;
  for (const double um : change_um) largest_um = std::max(largest_um, std::abs(um));
  return largest_um <= most_um ? 1.0 : most_um / largest_um;
}

Vector3 part_of_the_way(const Vector3& from, const Vector3& to, double share) noexcept {
  if (share >= 1.0) return to;
  return {from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share,
          from[2] + (to[2] - from[2]) * share};
}

void add_rotation(const Term& term, const UnitParameters& p, AngularAction& action, ToolAction& tool) noexcept {
  const std::size_t observed = index_of(term.observed);
  const std::size_t lever = index_of(term.lever);
  const double weight_per_mm = term.sign * p.angular_scale / 1000.0;
  const double line_mm = p.measurement_lines_mm[index_of(moving_axis(term.component))][lever];
  const double gain = term.uses_coordinate ? weight_per_mm : 0.0;
  const std::size_t product = 2 * lever + (observed == (lever + 2) % 3 ? 0 : 1);
  action.gain[product] = gain;
  tool.per_mm[product] = weight_per_mm;
  tool.without_tool[product] = -gain * line_mm;
}

void set_levers(CompiledMap& map, const Vector3& tool_offset_mm) noexcept {
  map.tool_offset_mm = tool_offset_mm;
  for (std::size_t a = 0; a < kAxes; ++a)
    for (std::size_t k = 0; k < 6; ++k)
      map.angular[a].constant[k] = map.tool[a].without_tool[k] + map.tool[a].per_mm[k] * tool_offset_mm[k / 2];
}

void compile_terms(const TermTable& terms, const UnitParameters& p, CompiledMap& map) noexcept {
  for (const Term& term : terms) {
    if (is_squareness(term.component))
      add_squareness(term, map.squareness_of_one);
    else if (term.has_lever)
      add_rotation(term, p, map.angular[index_of(moving_axis(term.component))],
                   map.tool[index_of(moving_axis(term.component))]);
  }
  set_levers(map, p.tool_offset_mm);
  set_squareness(map, {p.C0Y_um_per_m, p.B0Z_um_per_m, p.A0Z_um_per_m});
}

void compile_axes(const UnitParameters& p, CompiledMap& map) noexcept {
  map.period_s = p.loop_period_us * 1e-6;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const AxisParameters& from = p.axes[a];
    AxisWorking& axis = map.axes[a];
    axis.mm_per_count = from.position_scale_um_per_count / 1000.0;
    // a thousandth of a count more: travel of exactly the deadband is within it, whatever the rounding
    axis.deadband_mm = from.deadband_um / 1000.0 + std::abs(axis.mm_per_count) * 1e-3;
    if (!p.axis_present[a]) continue;
    OutputWorking& output = map.output;
    output.counts_per_um[a] = from.output_scale_counts_per_um * from.compensation_polarity;
    output.limit_counts[a] = std::min(from.output_limit_um * from.output_scale_counts_per_um, 32767.0);
    output.slew_counts[a] = from.output_slew_um_per_s * from.output_scale_counts_per_um * map.period_s;
    output.mm_per_output[a] = 1e-3 / output.counts_per_um[a];
    output.follow_part[a] = 1.0 - std::exp(-from.position_loop_gain_per_s * map.period_s);
    output.unsure_kept[a] = std::exp(-from.position_loop_gain_per_s * kSlowestFollowing * map.period_s);
  }
}

/// Both approaches of every needed curve are there, or the curve is declared zero.
CompileVerdict check_complete(const ImageView& image, const ComponentSet& needed) noexcept {
  for (std::size_t c = 0; c < kCurves; ++c) {
    if (!needed.has[c]) continue;
    bool forward = false;
    bool reverse = false;
    for (std::uint32_t i = 0; i < image.table_count(); ++i) {
      const TableEntry entry = image.entry(i);
      if (index_of(entry.component) != c) continue;
      forward = forward || entry.approach != Approach::reverse;
      reverse = reverse || entry.approach != Approach::forward;
    }
    if (!forward || !reverse) return {Fault::map_not_for_parameters, static_cast<Component>(c)};
  }
  return {};
}

void clear_working(CompiledMap& map) noexcept {
  map.curves = {};
  map.angular = {};
  map.tool = {};
  map.squareness_of_one = {};
  map.axes = {};
  map.output = {};
  map.value[0] = 0.0;
  map.slope[0] = 0.0;
}

void compile_thermal_rows(const ImageView& image, const UnitParameters& parameters, CompiledMap& map) noexcept {
  std::array<ThermalRow, kMostThermalRows> rows;
  const std::uint32_t count = image.thermal_count();
  for (std::uint32_t k = 0; k < count; ++k) rows[k] = image.thermal_row(k);
  const ThermalSettings settings = count > 0 ? image.thermal_settings() : ThermalSettings{};
  compile_thermal(std::span(rows).first(count), settings, parameters, map.thermal);
}

}  // namespace

CompileVerdict compile(const ImageView& image, CompiledMap& map) noexcept {
  const auto parameters = image.parameters();
  if (!parameters) return {Fault::bad_parameters, Component::EXX};
  const CompileVerdict complete = check_complete(image, components_needed(*parameters));
  if (complete.fault != Fault::none) return complete;
  const TermTable terms = *terms_of(*parameters);
  clear_working(map);
  compile_tables(image, parameters->interpolation, components_needed(terms, true), map);
  compile_terms(terms, *parameters, map);
  compile_axes(*parameters, map);
  compile_thermal_rows(image, *parameters, map);
  return {};
}

namespace {

using Six = std::array<double, 6>;

/// The curves of one axis at its position: EX EY EZ, and the rotations as AngularAction needs them, B C C A A B.
struct CurveValues {
  Vector3 translation;
  alignas(16) Six rotation;
};

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
  const auto value = [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(static_cast<std::int64_t>(cell[s]));
    return map.value[i] + map.slope[i] * cell[s];
  };
  const double ea = value(3);
  const double eb = value(4);
  const double ec = value(5);
  return {{value(0), value(1), value(2)}, {eb, ec, ec, ea, ea, eb}};
}

/// The six products of one moving axis.
inline Six turned_um(const AngularAction& action, const Six& rotation, const Six& lever_mm) noexcept {
  const double* const gain = std::assume_aligned<16>(action.gain.data());
  const double* const constant = std::assume_aligned<16>(action.constant.data());
  Six turned;
  for (std::size_t k = 0; k < 6; ++k) turned[k] = rotation[k] * (gain[k] * lever_mm[k] + constant[k]);
  return turned;
}

/// The rows of the term table in their compiled order (thesis 4.3).
inline Vector3 combine(const CompiledMap& map, const PerAxis<CurveValues>& values, const Vector3& p) noexcept {
  alignas(16) const Six lever_mm{p[0], p[0], p[1], p[1], p[2], p[2]};
  const Six by_x = turned_um(map.angular[0], values[0].rotation, lever_mm);
  const Six by_y = turned_um(map.angular[1], values[1].rotation, lever_mm);
  const Six by_z = turned_um(map.angular[2], values[2].rotation, lever_mm);
  Six turned;
  for (std::size_t k = 0; k < 6; ++k) turned[k] = by_x[k] + by_y[k] + by_z[k];
  const auto moved = [&](std::size_t o) {
    return values[0].translation[o] + values[1].translation[o] + values[2].translation[o];
  };
  const SquarenessAction& square = map.squareness;
  return {moved(0) + turned[2] + turned[5] + square.x_by_y * p[1] + square.x_by_z * p[2],
          moved(1) + turned[1] + turned[4] + square.y_by_z * p[2], moved(2) + turned[0] + turned[3]};
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
  const Lanes wanted_um{state.compensation_um[0], state.compensation_um[1], state.compensation_um[2], 0.0};
  const Lanes before = state.output_counts;
  const Lanes own_mm = state.own_motion_mm, unsure_mm = state.unsure_mm;
  Lanes asked, output, followed, unsure;
  for (std::size_t a = 0; a < 4; ++a) {
    asked[a] = wanted_um[a] * to.counts_per_um[a];
    const double least = before[a] - to.slew_counts[a];
    const double most = before[a] + to.slew_counts[a];
    const double above = asked[a] > -to.limit_counts[a] ? asked[a] : -to.limit_counts[a];
    const double sized = above < to.limit_counts[a] ? above : to.limit_counts[a];
    const double rising = sized > least ? sized : least;
    output[a] = rising < most ? rising : most;
    followed[a] = own_mm[a] + (output[a] * to.mm_per_output[a] - own_mm[a]) * to.follow_part[a];
    unsure[a] = unsure_mm[a] * to.unsure_kept[a] + std::abs((output[a] - before[a]) * to.mm_per_output[a]);
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

inline Vector3 compensated(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts) noexcept {
  const PerAxis<CurveValues> values{read_axis(map, state, counts, 0), read_axis(map, state, counts, 1),
                                    read_axis(map, state, counts, 2)};
  return combine(map, values, state.position_mm);
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
  state.compensation_um = compensated(map, state, counts);
  put_out(map.output, state);
  ++state.ticks;
}

void tick(const CompiledMap& map, TickState& state, const PerAxis<std::int64_t>& counts,
          const ThermalPolynomial& thermal) noexcept {
  state.compensation_um = compensated(map, state, counts);
  const Lanes warm_um = value_um(thermal, state.position_mm);
  for (std::size_t a = 0; a < kAxes; ++a) state.compensation_um[a] += warm_um[a];
  put_out(map.output, state);
  ++state.ticks;
}

Vector3 compensation_um_at(const CompiledMap& map, const Vector3& position_mm,
                           const PerAxis<Approach>& approach) noexcept {
  const auto values = [&](std::size_t a) { return look_up(map, map.curves[a][side_of(approach[a])], position_mm[a]); };
  return combine(map, {values(0), values(1), values(2)}, position_mm);
}

PerAxis<Vector3> tool_effect_um_per_mm(const CompiledMap& map, const TickState& state,
                                       const ThermalState& thermal) noexcept {
  PerAxis<Vector3> effect = thermal_tool_effect_um_per_mm(map.thermal, thermal);
  for (std::size_t a = 0; a < kAxes; ++a) {
    const CurveValues values = look_up(map, map.curves[a][side_of(state.approach[a])], state.position_mm[a]);
    for (std::size_t k = 0; k < 6; ++k) {
      const std::size_t lever = k / 2, observed = (lever + (k % 2 == 0 ? 2 : 1)) % 3;
      effect[lever][observed] += values.rotation[k] * map.tool[a].per_mm[k];
    }
  }
  return effect;
}

bool change_tool(CompiledMap& map, const TickState& state, ThermalState& thermal, const Vector3& offset_mm,
                 double most_um) noexcept {
  const PerAxis<Vector3> effect = tool_effect_um_per_mm(map, state, thermal);
  Vector3 change_um{};
  for (std::size_t l = 0; l < kAxes; ++l)
    for (std::size_t o = 0; o < kAxes; ++o) change_um[o] += effect[l][o] * (offset_mm[l] - map.tool_offset_mm[l]);
  const double share = share_within(change_um, most_um);
  const Vector3 next_mm = part_of_the_way(map.tool_offset_mm, offset_mm, share);
  set_levers(map, next_mm);
  set_tool_of_rows(map.thermal, thermal, next_mm);
  return share >= 1.0;
}

bool change_squareness(CompiledMap& map, const TickState& state, const Vector3& um_per_m, double most_um) noexcept {
  const SquarenessAction& of_one = map.squareness_of_one;
  const Vector3& now = map.squareness_um_per_m;
  const Vector3& at_mm = state.position_mm;
  const double share = share_within(
      {of_one.x_by_y * (um_per_m[0] - now[0]) * at_mm[1] + of_one.x_by_z * (um_per_m[1] - now[1]) * at_mm[2],
       of_one.y_by_z * (um_per_m[2] - now[2]) * at_mm[2], 0.0},
      most_um);
  set_squareness(map, part_of_the_way(now, um_per_m, share));
  return share >= 1.0;
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
