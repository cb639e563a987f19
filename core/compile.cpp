// The working form of a map: made when a map becomes active, and taken to another tool or squareness between two ticks.
// Does not live here: the tick (tick.cpp), the working form of rotary axes (rotary.cpp) and of thermal rows
// (thermal.cpp).
#include <algorithm>
#include <cmath>
#include <span>

#include "core/tick.hpp"

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

/// A head turns the tool: what does not turn with it is the pivot from which its arms count.
Vector3 unturned_tool_mm(const CompiledMap& map, const Vector3& tool_offset_mm) noexcept {
  return map.rotary.turns_tool() ? map.rotary.arm_from_mm : tool_offset_mm;
}

void set_levers(CompiledMap& map, const Vector3& tool_mm) noexcept {
  map.tool_offset_mm = tool_mm;
  const Vector3 tool_offset_mm = unturned_tool_mm(map, tool_mm);
  if (map.rotary.arrangement != RotaryWorking::Arrangement::none) set_rotary_tool(map.rotary, tool_mm);
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
    output.least_counts[a] = -output.limit_counts[a];
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
    if (!forward || !reverse) return {Fault::map_not_for_parameters, static_cast<Component>(c), RotaryFault::none};
  }
  return {};
}

void clear_working(CompiledMap& map) noexcept {
  map.curves = {};
  map.angular = {};
  map.tool = {};
  map.squareness_of_one = {};
  map.rotary.arrangement = RotaryWorking::Arrangement::none;
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
  if (!parameters) return {Fault::bad_parameters};
  const CompileVerdict complete = check_complete(image, components_needed(*parameters));
  if (complete.fault != Fault::none) return complete;
  const TermTable terms = *terms_of(*parameters);
  clear_working(map);
  compile_tables(image, parameters->interpolation, components_needed(terms, true), map);
  compile_terms(terms, *parameters, map);
  compile_axes(*parameters, map);
  compile_thermal_rows(image, *parameters, map);
  const auto machine = image.rotary();
  const RotaryFault fault = machine ? compile_rotary(*machine, *parameters, map) : RotaryFault::none;
  return {fault == RotaryFault::none ? Fault::none : Fault::map_not_for_parameters, Component::EXX, fault};
}

RotaryFault compile_rotary(const RotarySetup& machine, const UnitParameters& parameters, CompiledMap& map) noexcept {
  const RotaryFault fault = compile_rotary_axes(machine, parameters, map.rotary);
  set_levers(map, parameters.tool_offset_mm);
  ThermalState none;
  set_tool_of_rows(map.thermal, none, unturned_tool_mm(map, parameters.tool_offset_mm));
  return fault;
}

namespace {

/// Takes the map to this tool, or part of the way. @param per_mm  um along X, Y, Z for each mm along x, y, z
/// @param of_length  um for each mm of length, which changes by no more than the way
bool go_to_tool(CompiledMap& map, ThermalState& thermal, const PerAxis<Vector3>& per_mm, const Vector3& of_length,
                const Vector3& offset_mm, double most_um) noexcept {
  Vector3 change_um{};
  double way_mm = 0.0;
  for (std::size_t l = 0; l < kAxes; ++l) {
    const double mm = offset_mm[l] - map.tool_offset_mm[l];
    way_mm = std::hypot(way_mm, mm);
    for (std::size_t o = 0; o < kAxes; ++o) change_um[o] += per_mm[l][o] * mm;
  }
  for (std::size_t o = 0; o < kAxes; ++o) change_um[o] = std::abs(change_um[o]) + std::abs(of_length[o]) * way_mm;
  const double share = share_within(change_um, most_um);
  const Vector3 next_mm = part_of_the_way(map.tool_offset_mm, offset_mm, share);
  set_levers(map, next_mm);
  set_tool_of_rows(map.thermal, thermal, unturned_tool_mm(map, next_mm));
  return share >= 1.0;
}

}  // namespace

bool change_tool(CompiledMap& map, const TickState& state, ThermalState& thermal, const Vector3& offset_mm,
                 double most_um) noexcept {
  return go_to_tool(map, thermal, tool_effect_um_per_mm(map, state, thermal), {}, offset_mm, most_um);
}

bool change_tool(CompiledMap& map, const TickState& state, ThermalState& thermal, RotaryTickState& rotary,
                 const Vector3& offset_mm, double most_um) noexcept {
  return go_to_tool(map, thermal, tool_effect_um_per_mm(map, state, thermal, rotary), tool_bend_um_per_mm(map, rotary),
                    offset_mm, most_um);
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

}  // namespace ecs
