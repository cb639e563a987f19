#include "core/compiled_map.hpp"

#include <algorithm>

namespace ecs {
namespace {

std::size_t sense_index(Component c) noexcept { return static_cast<std::size_t>(sense_of(c)); }

/// Cells of one table: linear pieces, or steps of half an increment either side of each value.
void fill_cells(const ImageView& image, const TableEntry& entry, Interpolation interpolation, Cell* cells) noexcept {
  for (std::uint32_t k = 0; k < entry.count; ++k) {
    const double here = image.value_counts(entry.first_value + k) * entry.resolution;
    const bool slopes = interpolation == Interpolation::linear && k + 1 < entry.count;
    const double next = slopes ? image.value_counts(entry.first_value + k + 1) * entry.resolution : here;
    cells[k] = {here - (next - here) * k, next - here};
  }
}

void place_table(const TableEntry& entry, Interpolation interpolation, std::uint32_t first_cell, std::size_t side,
                 CompiledMap& map) noexcept {
  const std::size_t a = index_of(moving_axis(entry.component));
  const std::size_t s = sense_index(entry.component);
  const double half_step = interpolation == Interpolation::nearest ? 0.5 : 0.0;
  map.place_per_mm[a][side][s] = 1.0 / entry.increment_mm;
  map.place_offset[a][side][s] = half_step - entry.start_mm / entry.increment_mm;
  map.last_place[a][side][s] = entry.count - 1;
  map.lookup[a][side][s] = {first_cell, entry.first_value};
}

void compile_tables(const ImageView& image, Interpolation interpolation, CompiledMap& map) noexcept {
  map.cells[0] = {};
  std::uint32_t next_cell = 1;
  for (std::uint32_t i = 0; i < image.table_count(); ++i) {
    const TableEntry entry = image.entry(i);
    if (entry.declared_zero) continue;
    fill_cells(image, entry, interpolation, map.cells.data() + next_cell);
    if (entry.approach != Approach::reverse)
      place_table(entry, interpolation, next_cell, side_of(Approach::forward), map);
    if (entry.approach != Approach::forward)
      place_table(entry, interpolation, next_cell, side_of(Approach::reverse), map);
    next_cell += entry.count;
  }
}

/// Where a rotation term stands in AngularAction::weight.
std::size_t weight_index(const Term& term) noexcept {
  const bool first = (index_of(direction_of(sense_of(term.component))) + 2) % 3 == index_of(term.observed);
  return 2 * index_of(term.observed) + (first ? 0 : 1);
}

void compile_terms(const TermTable& terms, const UnitParameters& p, CompiledMap& map) noexcept {
  const Vector3 squareness{p.C0Y_um_per_m, p.B0Z_um_per_m, p.A0Z_um_per_m};
  for (const Term& term : terms) {
    const std::size_t observed = index_of(term.observed);
    const std::size_t lever = index_of(term.lever);
    if (is_squareness(term.component)) {
      // parameters hold the error, the unit adds compensation
      map.squareness_um_per_mm[observed][lever] += -term.sign * squareness[index_of(term.component) - kCurves] / 1000.0;
    } else if (!term.has_lever) {
      map.translation_weight[observed][index_of(moving_axis(term.component))] = term.sign;
    } else {
      const std::size_t b = index_of(moving_axis(term.component));
      AngularAction& action = map.angular[b];
      action.weight[weight_index(term)] = term.sign * p.angular_scale;
      if (term.uses_coordinate) action.lever_gain[lever] = 0.001;
      const double line_mm = term.uses_coordinate ? p.measurement_lines_mm[b][lever] : 0.0;
      action.lever_constant_m[lever] = (p.tool_offset_mm[lever] - line_mm) / 1000.0;
    }
  }
}

void compile_axes(const UnitParameters& p, CompiledMap& map) noexcept {
  map.period_s = p.loop_period_us * 1e-6;
  for (const Axis a : kAllAxes) {
    const AxisParameters& from = p.axes[index_of(a)];
    AxisWorking& to = map.axes[index_of(a)];
    to.present = p.axis_present[index_of(a)];
    to.mm_per_count = from.position_scale_um_per_count / 1000.0;
    to.deadband_mm = from.deadband_um / 1000.0;
    to.counts_per_um = to.present ? from.output_scale_counts_per_um * from.compensation_polarity : 0.0;
    to.limit_counts = std::min(from.output_limit_um * from.output_scale_counts_per_um, 32767.0);
    to.slew_counts = std::max(1.0, from.output_slew_um_per_s * from.output_scale_counts_per_um * map.period_s);
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
  map.place_per_mm = {};
  map.place_offset = {};
  map.last_place = {};
  map.lookup = {};
  map.angular = {};
  map.squareness_um_per_mm = {};
  map.translation_weight = {};
  map.axes = {};
}

}  // namespace

CompileVerdict compile(const ImageView& image, CompiledMap& map) noexcept {
  const auto parameters = image.parameters();
  if (!parameters) return {Fault::bad_parameters, Component::EXX};
  const CompileVerdict complete = check_complete(image, components_needed(*parameters));
  if (complete.fault != Fault::none) return complete;
  clear_working(map);
  compile_tables(image, parameters->interpolation, map);
  compile_terms(*terms_of(*parameters), *parameters, map);
  compile_axes(*parameters, map);
  return {};
}

}  // namespace ecs
