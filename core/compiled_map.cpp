#include "core/compiled_map.hpp"

#include <algorithm>
#include <cmath>

namespace ecs {
namespace {

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

void add_squareness(const Term& term, const UnitParameters& p, SquarenessAction& action) noexcept {
  // parameters hold the error, the unit adds compensation
  const double per_mm = -term.sign / 1000.0;
  if (term.component == Component::C0Y) action.x_by_y = per_mm * p.C0Y_um_per_m;
  if (term.component == Component::B0Z) action.x_by_z = per_mm * p.B0Z_um_per_m;
  if (term.component == Component::A0Z) action.y_by_z = per_mm * p.A0Z_um_per_m;
}

void add_rotation(const Term& term, const UnitParameters& p, AngularAction& action) noexcept {
  const std::size_t observed = index_of(term.observed);
  const std::size_t lever = index_of(term.lever);
  const double weight_per_mm = term.sign * p.angular_scale / 1000.0;
  const double line_mm = p.measurement_lines_mm[index_of(moving_axis(term.component))][lever];
  const double gain = term.uses_coordinate ? weight_per_mm : 0.0;
  const double constant = weight_per_mm * p.tool_offset_mm[lever] - gain * line_mm;
  const std::size_t product = 2 * lever + (observed == (lever + 2) % 3 ? 0 : 1);
  action.gain[product] = gain;
  action.constant[product] = constant;
}

void compile_terms(const TermTable& terms, const UnitParameters& p, CompiledMap& map) noexcept {
  for (const Term& term : terms) {
    if (is_squareness(term.component))
      add_squareness(term, p, map.squareness);
    else if (term.has_lever)
      add_rotation(term, p, map.angular[index_of(moving_axis(term.component))]);
  }
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
  map.squareness = {};
  map.axes = {};
  map.output = {};
  map.value[0] = 0.0;
  map.slope[0] = 0.0;
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
  return {};
}

}  // namespace ecs
