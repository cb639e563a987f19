// SINUMERIK 840D: which tables a map becomes. Does not live here: their text (controller_siemens_text.cpp), reading
// (controller_siemens_reader.cpp).
#include "laser/controller_siemens.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "laser/controller_siemens_tables.hpp"

namespace ecs::laser {
namespace {

constexpr double kUmPerMm = 1000.0;
constexpr double kNothing_um = 0.0005;  ///< below the last digit written

/// Tables that only make sense together: the two directions of one component.
struct Group {
  std::vector<SiemensTable> tables;
  ExportedTable report;
  [[nodiscard]] double largest() const {
    double most = 0.0;
    for (const SiemensTable& table : tables) most = std::max(most, table.largest());
    return most;
  }
};

double reference_mm(const ExportSource& source, Axis axis) {
  return source.parameters.axes[index_of(axis)].datum.reference_position_mm;
}

bool has_axis(const ExportSource& source, Axis axis) { return source.parameters.axis_present[index_of(axis)]; }

double largest_reversal(const ControlCurve& curve) {
  double most = 0.0;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    most = std::max(most, std::abs(curve.forward[i] - curve.reverse[i]));
  return most;
}

/// A curve of the map on an even grid, zero (mean of both approaches) at the reference position.
struct Gridded {
  EvenGrid grid;
  ControlCurve curve;
  double shift_um = 0.0;
  double deviation_um = 0.0;
  std::size_t map_points = 0;
};
std::optional<Gridded> gridded(const ExportSource& source, Component component, std::size_t most_points) {
  const auto curve = curve_of(source.map, component);
  if (!curve) return std::nullopt;
  Gridded made;
  made.map_points = curve->position_mm.size();
  made.grid = even_grid(*curve, most_points);
  made.curve = resampled(*curve, made.grid.positions());
  made.deviation_um = deviation_from_unit(made.curve, source.map, component, source.parameters.interpolation);
  made.shift_um = mean_at(made.curve, reference_mm(source, moving_axis(component)));
  for (auto* side : {&made.curve.forward, &made.curve.reverse})
    for (double& value : *side) value -= made.shift_um;
  return made;
}

Group group_of(Component component, const Gridded& from, std::vector<SiemensTable> tables, std::string what) {
  Group group{std::move(tables), {}};
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

/// Positioning: the mean for the encoder table, half the difference for each direction of the reversal.
struct Positioning {
  std::vector<SiemensTable> encoder;
  std::vector<Group> reversal;
  std::vector<ExportedTable> reports;
};
Positioning positioning_of(const ExportSource& source, const SiemensOptions& options) {
  Positioning all;
  for (const Axis axis : kAllAxes) {
    const Component component = curve_of(static_cast<Sense>(axis), axis);
    const auto from = has_axis(source, axis) ? gridded(source, component, options.most_points) : std::nullopt;
    if (!from) continue;
    const auto& c = from->curve;
    const auto mean = [&](std::size_t i) { return 0.5 * (c.forward[i] + c.reverse[i]); };
    const auto half = [&](std::size_t i) { return 0.5 * (c.forward[i] - c.reverse[i]); };
    all.encoder.push_back(table_on(*from, component, 0, mean, "mean of both approaches"));
    Group report = group_of(component, *from, {all.encoder.back()}, fmt::format("ENC_COMP of {}", letter_of(axis)));
    all.reports.push_back(report.report);
    if (largest_reversal(c) < kNothing_um) continue;
    Group pair = group_of(component, *from,
                          {table_on(*from, component, 1, half, "reversal, forward"),
                           table_on(
                               *from, component, -1, [&](std::size_t i) { return -half(i); }, "reversal, reverse")},
                          fmt::format("CEC {0} to {0}, reversal, two directions", letter_of(axis)));
    pair.report.shift = 0.0;
    all.reversal.push_back(std::move(pair));
  }
  return all;
}

std::vector<Group> straightness_of(const ExportSource& source, const SiemensOptions& options, bool both_ways) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto component = static_cast<Component>(i);
    if (!is_straightness(component)) continue;
    const Axis input = moving_axis(component), output = direction_of(sense_of(component));
    if (!has_axis(source, input) || !has_axis(source, output)) continue;
    const auto from = gridded(source, component, options.most_points);
    if (!from) continue;
    const auto& c = from->curve;
    const std::string pair = fmt::format("CEC {} to {}", letter_of(input), letter_of(output));
    if (both_ways && largest_reversal(c) >= kNothing_um) {
      groups.push_back(
          group_of(component, *from,
                   {table_on(
                        *from, component, 1, [&](std::size_t k) { return c.forward[k]; }, "straightness, forward"),
                    table_on(
                        *from, component, -1, [&](std::size_t k) { return c.reverse[k]; }, "straightness, reverse")},
                   pair + ", two directions"));
      continue;
    }
    const auto mean = [&](std::size_t k) { return 0.5 * (c.forward[k] + c.reverse[k]); };
    groups.push_back(group_of(component, *from, {table_on(*from, component, 0, mean, "straightness")}, pair));
    if (groups.back().largest() < kNothing_um) groups.pop_back();
  }
  return groups;
}

/// Squareness is a line over the travel of its lever axis.
std::vector<Group> squareness_lines(const ExportSource& source) {
  std::vector<Group> groups;
  const auto values = squareness_of(source.parameters);
  const auto chain = chain_of(source.parameters);
  const auto terms = chain ? terms_of(*chain, source.parameters.convention, CurveKind::measured) : std::nullopt;
  if (!terms) return groups;
  for (const Term& term : *terms) {
    if (!is_squareness(term.component) || values[index_of(term.component)] == 0.0) continue;
    const auto& travel = source.travel_mm[index_of(term.lever)];
    if (!travel || !has_axis(source, term.observed)) continue;
    const double per_mm = -term.sign * values[index_of(term.component)] / 1000.0;
    const double step_mm = std::ceil(((*travel)[1] - (*travel)[0]) * 1e6 - 1e-3) * 1e-6;
    const Component curve = curve_of(static_cast<Sense>(term.observed), term.lever);
    SiemensTable line{
        curve, std::string(name_of(term.component)), term.lever, term.observed,
        0,     {(*travel)[0], step_mm, 2},           {},         fmt::format("squareness {}", name_of(term.component))};
    const double reference = reference_mm(source, term.lever);
    for (const double p : line.grid.positions()) line.compensation_um.push_back(per_mm * (p - reference));
    Group group{{line}, {}};
    group.report = {line.name,
                    fmt::format("CEC {} to {}, a line", letter_of(term.lever), letter_of(term.observed)),
                    0,
                    2,
                    group.largest(),
                    0.0,
                    per_mm * reference};
    groups.push_back(std::move(group));
  }
  return groups;
}

std::size_t tables_in(const std::vector<Group>& groups) {
  std::size_t count = 0;
  for (const Group& group : groups) count += group.tables.size();
  return count;
}

/// Within the number of tables that the control has; what had to go is told.
std::vector<Group> chosen(const ExportSource& source, const SiemensOptions& options, std::vector<Group> reversal,
                          ControllerExport& made) {
  const auto all_with = [&](bool both_ways) {
    std::vector<Group> all = squareness_lines(source);
    for (Group& group : straightness_of(source, options, both_ways)) all.push_back(std::move(group));
    all.insert(all.end(), reversal.begin(), reversal.end());
    return all;
  };
  std::vector<Group> groups = all_with(true);
  if (tables_in(groups) > options.most_tables) {
    made.notes.push_back(
        fmt::format("{} CEC tables would be needed, the control has {}: straightness keeps the mean of "
                    "both approaches",
                    tables_in(groups), options.most_tables));
    groups = all_with(false);
  }
  while (tables_in(groups) > options.most_tables) {
    const auto least = std::min_element(groups.begin(), groups.end(),
                                        [](const Group& a, const Group& b) { return a.largest() < b.largest(); });
    if (least->tables.front().input == least->tables.front().output)  // the encoder table still carries the mean
      made.not_carried.push_back({fmt::format("half the reversal of {}", least->report.component), least->largest(),
                                  "um", "more cross tables would be needed than the control has"});
    groups.erase(least);
  }
  return groups;
}

// --- what to set

std::vector<SiemensTable> all_tables(const std::vector<Group>& groups) {
  std::vector<SiemensTable> all;
  for (const Group& group : groups) all.insert(all.end(), group.tables.begin(), group.tables.end());
  return all;
}

/// A line for each stretch of tables of the same length.
void add_cross_points(ControllerExport& made, const std::vector<SiemensTable>& tables) {
  for (std::size_t first = 0, last = 0; first < tables.size(); first = last) {
    while (last < tables.size() && tables[last].grid.points == tables[first].grid.points) ++last;
    made.settings.push_back(
        fmt::format("MD18342 $MN_MM_CEC_MAX_POINTS[{}] = {}",
                    last - first == 1 ? fmt::format("{}", first) : fmt::format("{} ... {}", first, last - 1),
                    tables[first].grid.points));
  }
}

void add_settings(ControllerExport& made, const std::vector<SiemensTable>& encoder, const std::vector<Group>& groups,
                  const SiemensOptions& options) {
  for (const SiemensTable& table : encoder)
    made.settings.push_back(fmt::format("MD38000 $MA_MM_ENC_COMP_MAX_POINTS[{},{}] = {}", options.encoder,
                                        options.axis_name[index_of(table.input)], table.grid.points));
  int t = 0;
  PerAxis<double> sum_um{};
  add_cross_points(made, all_tables(groups));
  for (const Group& group : groups)
    for (const SiemensTable& table : group.tables) {
      ++t;
      if (table.direction >= 0) sum_um[index_of(table.output)] += table.largest();
    }
  for (const SiemensTable& table : encoder)
    made.settings.push_back(fmt::format("MD32700 $MA_ENC_COMP_ENABLE[{},{}] = 1, after loading", options.encoder,
                                        options.axis_name[index_of(table.input)]));
  for (const Axis axis : kAllAxes)
    if (sum_um[index_of(axis)] > 0.0) {
      const std::string& name = options.axis_name[index_of(axis)];
      made.settings.push_back(fmt::format("MD32710 $MA_CEC_ENABLE[{}] = 1, after loading", name));
      made.settings.push_back(
          fmt::format("MD32720 $MA_CEC_MAX_SUM[{}] of at least {:.3f} mm", name, sum_um[index_of(axis)] / kUmPerMm));
    }
  if (t > 0) made.settings.push_back(fmt::format("SD41300 $SN_CEC_TABLE_ENABLE[0 ... {}] = 1", t - 1));
}

Result<void> take_back(ControllerExport& made, const SiemensOptions& options) {
  for (const ExportFile& file : made.files) {
    auto again = parse_siemens(file.content, file.name, options);
    if (!again) return tl::unexpected(again.error());
    if (auto done = append(made.applied, std::move(*again), false); !done) return done;
  }
  made.applied.sources.clear();
  return {};
}

}  // namespace

Result<ControllerExport> siemens_export(const ExportSource& source, const SiemensOptions& options) {
  if (const auto sound = check_exportable(source.map); !sound) return tl::unexpected(sound.error());
  ControllerExport made;
  Positioning positioning = positioning_of(source, options);
  const std::vector<Group> groups = chosen(source, options, std::move(positioning.reversal), made);
  if (positioning.encoder.empty() && groups.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning, straightness or squareness of the machine's axes");
  std::vector<Component> carried;
  made.tables = positioning.reports;
  for (const SiemensTable& table : positioning.encoder) carried.push_back(table.component);
  for (const Group& group : groups) {
    carried.push_back(*component_of(group.report.component));
    made.tables.push_back(group.report);
  }
  if (!positioning.encoder.empty()) made.files.push_back({"AX_EEC.INI", encoder_text(positioning.encoder, options)});
  if (!groups.empty()) made.files.push_back({"NC_CEC.INI", cross_text(all_tables(groups), options)});
  add_settings(made, positioning.encoder, groups, options);
  leave_behind(made, source, carried, "a table has no lever arm",
               "more cross tables would be needed than the control has");
  made.notes.push_back("changing MD18342 or MD38000 reformats the memory of the control: save its data first");
  made.notes.push_back(
      "signs: the manual prints that of ENC_COMP; that of CEC is taken to be the same. Check one CEC "
      "table on the machine; --cec-sign adds writes the other (docs/controllers.md)");
  if (auto done = take_back(made, options); !done) return tl::unexpected(done.error());
  return made;
}

}  // namespace ecs::laser
