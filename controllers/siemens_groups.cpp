// SINUMERIK 840D: the tables of positioning, straightness and squareness.
// (siemens.cpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>

#include "controllers/siemens_tables.hpp"

namespace ecs::controllers {
namespace {

double reference_mm(const ExportSource& source, Axis axis) {
  return source.parameters.axes[index_of(axis)].datum.reference_position_mm;
}

bool has_axis(const ExportSource& source, Axis axis) { return source.parameters.axis_present[index_of(axis)]; }

/// Squareness as compensation of the output axis by the position of the input axis: a line over its travel.
struct SquareLine {
  Component square = Component::C0Y;
  Component curve = Component::EXY;  ///< the straightness between the same axes
  Axis input = Axis::Y, output = Axis::X;
  double um_per_mm = 0.0;
  std::array<double, 2> travel_mm{};
};
std::vector<SquareLine> square_lines_of(const ExportSource& source) {
  std::vector<SquareLine> lines;
  const auto values = squareness_of(source.parameters);
  const auto chain = chain_of(source.parameters);
  const auto terms = chain ? terms_of(*chain, source.parameters.convention, CurveKind::measured) : std::nullopt;
  if (!terms) return lines;
  for (const Term& term : *terms) {
    if (!is_squareness(term.component) || values[index_of(term.component)] == 0.0) continue;
    const auto& travel = source.travel_mm[index_of(term.lever)];
    if (!travel || !has_axis(source, term.observed)) continue;
    lines.push_back({term.component, curve_of(static_cast<Sense>(term.observed), term.lever), term.lever, term.observed,
                     -term.sign * values[index_of(term.component)] / 1000.0, *travel});
  }
  return lines;
}

/// A curve of the map on an even grid, zero (mean of both approaches) at the reference position.
struct Gridded {
  EvenGrid grid;
  ControlCurve curve;
  double shift_um = 0.0;
  double deviation_um = 0.0;
  std::size_t map_points = 0;
};
/// @param line  added to the curve, which then reaches over the whole travel
std::optional<Gridded> gridded(const ExportSource& source, Component component, std::size_t most_points,
                               const SquareLine* line = nullptr) {
  auto curve = curve_of(source.map, component);
  if (!curve) return std::nullopt;
  Gridded made;
  made.map_points = curve->position_mm.size();
  if (line != nullptr) {
    std::set<double> positions(curve->position_mm.begin(), curve->position_mm.end());
    positions.insert(line->travel_mm.begin(), line->travel_mm.end());
    curve = resampled(*curve, {positions.begin(), positions.end()});
  }
  made.grid = even_grid(*curve, most_points);
  made.curve = resampled(*curve, made.grid.positions());
  made.deviation_um = deviation_from_unit(made.curve, source.map, component, source.parameters.interpolation);
  for (std::size_t i = 0; line != nullptr && i < made.curve.position_mm.size(); ++i)
    for (auto* side : {&made.curve.forward, &made.curve.reverse})
      (*side)[i] += line->um_per_mm * made.curve.position_mm[i];
  made.shift_um = mean_at(made.curve, reference_mm(source, moving_axis(component)));
  for (auto* side : {&made.curve.forward, &made.curve.reverse})
    for (double& value : *side) value -= made.shift_um;
  return made;
}

SiemensGroup group_of(Component component, const Gridded& from, std::vector<SiemensTable> tables, std::string what) {
  SiemensGroup group{std::move(tables), {}, std::nullopt};
  group.report = {std::string(name_of(component)),
                  std::move(what),
                  from.map_points,
                  from.grid.points,
                  0.0,
                  from.deviation_um,
                  from.shift_um};
  group.report.largest = group.largest();
  return group;
}

SiemensTable table_on(const Gridded& from, Component component, int direction,
                      const std::function<double(std::size_t)>& value, std::string comment) {
  SiemensTable table{component,
                     std::string(name_of(component)),
                     moving_axis(component),
                     direction_of(sense_of(component)),
                     direction,
                     from.grid,
                     {},
                     std::move(comment)};
  for (std::size_t i = 0; i < from.grid.points; ++i) table.compensation_um.push_back(value(i));
  return table;
}

std::vector<SiemensTable> straightness_tables(const Gridded& from, Component component, bool mean_only) {
  const auto& c = from.curve;
  if (!mean_only && largest_reversal(c) >= kNothing_um) {
    const auto forward = [&](std::size_t k) { return c.forward[k]; };
    const auto reverse = [&](std::size_t k) { return c.reverse[k]; };
    return {table_on(from, component, 1, forward, "straightness, forward"),
            table_on(from, component, -1, reverse, "straightness, reverse")};
  }
  const auto mean = [&](std::size_t k) { return 0.5 * (c.forward[k] + c.reverse[k]); };
  return {table_on(from, component, 0, mean, "straightness")};
}

}  // namespace

double largest_reversal(const ControlCurve& curve) {
  double most = 0.0;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    most = std::max(most, std::abs(curve.forward[i] - curve.reverse[i]));
  return most;
}

SiemensPositioning positioning_of(const ExportSource& source, const SiemensOptions& options) {
  SiemensPositioning all;
  for (const Axis axis : kAllAxes) {
    const Component component = curve_of(static_cast<Sense>(axis), axis);
    const auto from = has_axis(source, axis) ? gridded(source, component, options.most_points) : std::nullopt;
    if (!from) continue;
    const auto& c = from->curve;
    const auto mean = [&](std::size_t i) { return 0.5 * (c.forward[i] + c.reverse[i]); };
    const auto half = [&](std::size_t i) { return 0.5 * (c.forward[i] - c.reverse[i]); };
    all.encoder.push_back(table_on(*from, component, 0, mean, "mean of both approaches"));
    SiemensGroup report =
        group_of(component, *from, {all.encoder.back()}, fmt::format("ENC_COMP of {}", letter_of(axis)));
    all.reports.push_back(report.report);
    if (largest_reversal(c) < kNothing_um) continue;
    SiemensGroup pair =
        group_of(component, *from,
                 {table_on(*from, component, 1, half, "reversal, forward"),
                  table_on(
                      *from, component, -1, [&](std::size_t i) { return -half(i); }, "reversal, reverse")},
                 fmt::format("CEC {0} to {0}, reversal, two directions", letter_of(axis)));
    pair.report.shift = 0.0;
    all.reversal.push_back(std::move(pair));
  }
  return all;
}

std::vector<SiemensGroup> straightness_of(const ExportSource& source, const SiemensOptions& options,
                                          const SiemensThrift& thrift) {
  std::vector<SiemensGroup> groups;
  const std::vector<SquareLine> lines = square_lines_of(source);
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto component = static_cast<Component>(i);
    if (!is_straightness(component)) continue;
    const Axis input = moving_axis(component), output = direction_of(sense_of(component));
    if (!has_axis(source, input) || !has_axis(source, output)) continue;
    const auto line = std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.curve == component; });
    const bool inside = thrift.squareness_inside && line != lines.end();
    const auto from = gridded(source, component, options.most_points, inside ? &*line : nullptr);
    if (!from) continue;
    auto tables = straightness_tables(*from, component, thrift.mean_only);
    const std::string what = fmt::format("CEC {} to {}{}{}", letter_of(input), letter_of(output),
                                         inside ? fmt::format(" with {}", name_of(line->square)) : std::string(),
                                         tables.size() > 1 ? ", two directions" : "");
    SiemensGroup group = group_of(component, *from, std::move(tables), what);
    if (inside) group.square = line->square;
    if (group.largest() >= kNothing_um) groups.push_back(std::move(group));
  }
  return groups;
}

/// Each squareness that no straightness table holds, as a table of two points.
std::vector<SiemensGroup> squareness_groups(const ExportSource& source, const std::vector<SiemensGroup>& straightness) {
  std::vector<SiemensGroup> groups;
  for (const SquareLine& line : square_lines_of(source)) {
    if (std::any_of(straightness.begin(), straightness.end(),
                    [&](const SiemensGroup& group) { return group.square == line.square; }))
      continue;
    const double step_mm = std::ceil((line.travel_mm[1] - line.travel_mm[0]) * 1e6 - 1e-3) * 1e-6;
    const std::string name(name_of(line.square));
    SiemensTable table{line.curve, name,
                       line.input, line.output,
                       0,          {line.travel_mm[0], step_mm, 2},
                       {},         fmt::format("squareness {}", name)};
    const double reference = reference_mm(source, line.input);
    for (const double p : table.grid.positions()) table.compensation_um.push_back(line.um_per_mm * (p - reference));
    SiemensGroup group{{table}, {}, std::nullopt};
    group.report = {name,
                    fmt::format("CEC {} to {}, a line", letter_of(line.input), letter_of(line.output)),
                    0,
                    2,
                    0.0,
                    0.0,
                    line.um_per_mm * reference};
    group.report.largest = group.largest();
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace ecs::controllers
