// SINUMERIK 840D, writing: the tables of positioning, straightness and squareness, their text, and which of them fit
// into the control. Does not live here: reading (siemens_reader.cpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

/// One table for the control, still as compensation.
struct SiemensTable {
  Component component = Component::EXX;
  std::string name;  ///< of the component in the report
  Axis input = Axis::X, output = Axis::X;
  int direction = 0;  ///< $AN_CEC_DIRECTION: 0 both, 1, -1
  EvenGrid grid;
  std::vector<double> compensation_um;
  std::string comment;
  [[nodiscard]] double largest() const {
    double most = 0.0;
    for (const double value : compensation_um) most = std::max(most, std::abs(value));
    return most;
  }
};

constexpr double kNothing_um = 0.0005;  ///< below the last digit written

/// Tables that only make sense together: the two directions of one component.
struct SiemensGroup {
  std::vector<SiemensTable> tables;
  ExportedTable report;
  std::optional<Component> square;  ///< a squareness that the tables hold besides
  [[nodiscard]] double largest() const {
    double most = 0.0;
    for (const SiemensTable& table : tables) most = std::max(most, table.largest());
    return most;
  }
};

/// Positioning: the mean for the encoder table, half the difference for each direction of the reversal.
struct SiemensPositioning {
  std::vector<SiemensTable> encoder;
  std::vector<SiemensGroup> reversal;
  std::vector<ExportedTable> reports;
};

/// How cross tables are spared: squareness inside straightness, straightness by its mean.
struct SiemensThrift {
  bool squareness_inside = false;
  bool mean_only = false;
};

double reference_mm(const ExportSource& source, Axis axis) {
  return source.parameters.axes[index_of(axis)].datum.reference_position_mm;
}

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

SiemensPositioning positioning_of(const ExportSource& source, const SiemensOptions& options) {
  SiemensPositioning all;
  for (const Axis axis : kAllAxes) {
    const Component component = positioning_curve(axis);
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
    const auto line = std::ranges::find_if(lines, [&](const auto& l) { return l.curve == component; });
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
    if (std::ranges::any_of(straightness, [&](const SiemensGroup& group) { return group.square == line.square; }))
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

constexpr int kDigits = 6;  ///< of mm: one nanometre

std::string grid_lines(std::string_view variable, const std::string& index, const EvenGrid& grid) {
  const double last = grid.first_mm + grid.step_mm * static_cast<double>(grid.points - 1);
  return fmt::format("{0}_STEP[{1}]={2:.{5}f}\n{0}_MIN[{1}]={3:.{5}f}\n{0}_MAX[{1}]={4:.{5}f}\n", variable, index,
                     grid.step_mm, grid.first_mm, last, kDigits);
}

/// The error in mm that a compensation stands for.
std::string value_text(double compensation_um) { return fixed_text(-compensation_um / kUmPerMm, kDigits); }

std::string encoder_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options) {
  std::string text =
      "%_N_AX_EEC_INI\n; value = error in mm: a positive value moves the axis in the negative direction\n";
  for (const SiemensTable& table : tables)
    text += fmt::format("; needs MD38000 $MA_MM_ENC_COMP_MAX_POINTS[{},{}] of at least {}\n", options.encoder,
                        options.axis_name[index_of(table.input)], table.grid.points);
  text += "; load with MD32700 $MA_ENC_COMP_ENABLE = 0\nCHANDATA(1)\n";
  for (const SiemensTable& table : tables) {
    const std::string axis = options.axis_name[index_of(table.input)];
    const std::string index = fmt::format("{},{}", options.encoder, axis);
    text += fmt::format("; {} {}\n", table.name, table.comment) + grid_lines("$AA_ENC_COMP", index, table.grid);
    text += fmt::format("$AA_ENC_COMP_IS_MODULO[{}]=0\n", index);
    for (std::size_t k = 0; k < table.compensation_um.size(); ++k)
      text +=
          fmt::format("$AA_ENC_COMP[{},{},{}]={}\n", options.encoder, k, axis, value_text(table.compensation_um[k]));
  }
  return text + "M17\n";
}

/// `NC_CEC.INI`: numbered from 0 in this order.
std::string cross_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options) {
  std::string needs, body;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    const SiemensTable& table = tables[t];
    needs += fmt::format("; needs MD18342 $MN_MM_CEC_MAX_POINTS[{}] of at least {}\n", t, table.grid.points);
    body += fmt::format("; table {}: {} {}\n", t, table.name, table.comment);
    body += fmt::format("$AN_CEC_INPUT_AXIS[{0}]=({1})\n$AN_CEC_OUTPUT_AXIS[{0}]=({2})\n", t,
                        options.axis_name[index_of(table.input)], options.axis_name[index_of(table.output)]);
    body += grid_lines("$AN_CEC", std::to_string(t), table.grid);
    body += fmt::format("$AN_CEC_DIRECTION[{0}]={1}\n$AN_CEC_MULT_BY_TABLE[{0}]=0\n$AN_CEC_IS_MODULO[{0}]=0\n", t,
                        table.direction);
    for (std::size_t k = 0; k < table.compensation_um.size(); ++k)
      body += fmt::format("$AN_CEC[{},{}]={}\n", t, k,
                          value_text(table.compensation_um[k] * (options.cec_adds ? -1.0 : 1.0)));
  }
  return fmt::format("%_N_NC_CEC_INI\n; value in mm: a positive value moves the output axis in the {} direction\n",
                     options.cec_adds ? "positive" : "negative") +
         needs + "; load with MD32710 $MA_CEC_ENABLE = 0\nCHANDATA(1)\n" + body + "M17\n";
}

constexpr const char* kEncoderFile = "AX_EEC.INI";
constexpr const char* kCrossFile = "NC_CEC.INI";

std::size_t tables_in(const std::vector<SiemensGroup>& groups) {
  std::size_t count = 0;
  for (const SiemensGroup& group : groups) count += group.tables.size();
  return count;
}

const char* const kTooFew = "more cross-axis (CEC) tables would be needed than the control has";

void leave_reversal_behind(ControllerExport& made, std::string_view component, double half_um) {
  if (half_um >= kNothing_um)
    made.not_carried.push_back({fmt::format("half the reversal of {}", component), half_um, "um", kTooFew});
}

/// Tables that know the direction, instead of one by the mean, or beside the encoder table.
struct Upgrade {
  SiemensGroup with;
  std::size_t cost = 0;  ///< tables more
  double gain_um = 0.0;  ///< half the reversal
};

std::vector<Upgrade> upgrades_of(const ExportSource& source, const SiemensOptions& options,
                                 const std::vector<SiemensGroup>& reversal) {
  std::vector<Upgrade> all;
  for (SiemensGroup& group : straightness_of(source, options, {true, false})) {
    const auto curve = curve_of(source.map, group.tables.front().component);
    if (group.tables.size() > 1) all.push_back({std::move(group), 1, 0.5 * largest_reversal(*curve)});
  }
  for (const SiemensGroup& pair : reversal) all.push_back({pair, 2, pair.largest()});
  std::ranges::stable_sort(all, [](const Upgrade& a, const Upgrade& b) {
    return a.gain_um * static_cast<double>(b.cost) > b.gain_um * static_cast<double>(a.cost);
  });
  return all;
}

/// Means first, then both directions where a table more brings most; what has to go is told.
std::vector<SiemensGroup> spared(const ExportSource& source, const SiemensOptions& options,
                                 const std::vector<SiemensGroup>& reversal, ControllerExport& made) {
  std::vector<SiemensGroup> groups = straightness_of(source, options, {true, true});
  for (SiemensGroup& line : squareness_groups(source, groups)) groups.push_back(std::move(line));
  while (tables_in(groups) > options.most_tables)
    groups.erase(std::ranges::min_element(
        groups, [](const SiemensGroup& a, const SiemensGroup& b) { return a.largest() < b.largest(); }));
  for (Upgrade& upgrade : upgrades_of(source, options, reversal)) {
    const bool beside = upgrade.cost == 2;
    const auto same = std::ranges::find_if(
        groups, [&](const SiemensGroup& group) { return group.report.component == upgrade.with.report.component; });
    const bool fits = tables_in(groups) + upgrade.cost <= options.most_tables && (beside || same != groups.end());
    if (!fits) {
      if (beside || same != groups.end()) leave_reversal_behind(made, upgrade.with.report.component, upgrade.gain_um);
    } else if (beside) {
      groups.push_back(std::move(upgrade.with));
    } else {
      *same = std::move(upgrade.with);
    }
  }
  return groups;
}

/// Within the number of tables that the control has.
std::vector<SiemensGroup> chosen(const ExportSource& source, const SiemensOptions& options,
                                 const std::vector<SiemensGroup>& reversal, ControllerExport& made) {
  const auto straightness = straightness_of(source, options, {});
  std::vector<SiemensGroup> groups = squareness_groups(source, straightness);
  groups.insert(groups.end(), straightness.begin(), straightness.end());
  groups.insert(groups.end(), reversal.begin(), reversal.end());
  if (tables_in(groups) <= options.most_tables) return groups;
  made.notes.push_back(fmt::format(
      "{} cross-axis (CEC) tables would be needed, but the control has {}: squareness is included in the straightness "
      "tables of the same axes, and only the largest reversals have two directions",
      tables_in(groups), options.most_tables));
  return spared(source, options, reversal, made);
}

// --- what to set

std::vector<SiemensTable> all_tables(const std::vector<SiemensGroup>& groups) {
  std::vector<SiemensTable> all;
  for (const SiemensGroup& group : groups) all.insert(all.end(), group.tables.begin(), group.tables.end());
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

void add_settings(ControllerExport& made, const std::vector<SiemensTable>& encoder,
                  const std::vector<SiemensGroup>& groups, const SiemensOptions& options) {
  for (const SiemensTable& table : encoder)
    made.settings.push_back(fmt::format("MD38000 $MA_MM_ENC_COMP_MAX_POINTS[{},{}] = {}", options.encoder,
                                        options.axis_name[index_of(table.input)], table.grid.points));
  int t = 0;
  PerAxis<double> sum_um{};
  add_cross_points(made, all_tables(groups));
  for (const SiemensGroup& group : groups)
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
      made.settings.push_back(fmt::format("MD32720 $MA_CEC_MAX_SUM[{}] of at least {:.3f} mm", name,
                                          std::ceil(sum_um[index_of(axis)]) / kUmPerMm));
    }
  if (t > 0) made.settings.push_back(fmt::format("SD41300 $SN_CEC_TABLE_ENABLE[0 ... {}] = 1", t - 1));
}

Result<void> take_back(ControllerExport& made, const SiemensOptions& options) {
  for (const ExportFile& file : made.files) {
    auto again = parse_siemens(file.content, file.name, options);
    if (!again) return unwritable(again.error());
    if (auto done = append(made.applied, std::move(*again), false); !done) return done;
  }
  made.applied.sources.clear();
  return {};
}

bool is_axis_name(std::string_view name) {
  constexpr std::size_t kLongest = 16;
  const auto fits = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name.size() <= kLongest && std::ranges::all_of(name, fits);
}

Result<SiemensOptions> siemens_options(const OptionValues& values) {
  SiemensOptions options;
  const std::string_view axes = values.text("axes");
  options.encoder = values.integer("encoder");
  options.cec_adds = values.text("cec-sign") == "adds";
  for (const auto& [axis, name] : axis_pairs(axes)) {
    if (!axis || !is_axis_name(name))
      return problem(ProblemKind::usage, "--axes: expected X=NAME,Y=NAME,Z=NAME, as in X=AX1, found \"{}\"", axes);
    options.axis_name[index_of(*axis)] = std::string(name);
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && lower(options.axis_name[index_of(a)]) == lower(options.axis_name[index_of(b)]))
        return problem(ProblemKind::usage, "--axes: {} and {} have the same name {}", letter_of(a), letter_of(b),
                       options.axis_name[index_of(a)]);
  return options;
}

Result<ControllerExport> write_siemens(const ExportSource& source, const OptionValues& values) {
  ECS_TRY(options, siemens_options(values));
  options.most_points = static_cast<std::size_t>(values.integer("points"));
  options.most_tables = static_cast<std::size_t>(values.integer("tables"));
  return siemens_export(source, options);
}

Result<ControllerTables> read_siemens(const ReadRequest& request) {
  ECS_TRY(options, siemens_options(request.options));
  return parse_siemens(request.text, request.file_name, options);
}

bool has_siemens_tables(std::string_view text) {
  const std::string plain = lower(text);
  return plain.find("$aa_enc_comp") != std::string::npos || plain.find("$an_cec") != std::string::npos;
}

const FormatOption kAxesOption{.name = "axes", .help = "axes of the control; default X=AX1,Y=AX2,Z=AX3"};
const FormatOption kEncoder{.name = "encoder",
                            .help = "measuring system 0 or 1 of $AA_ENC_COMP; default 0",
                            .fallback = "0",
                            .range = IntegerRange{0, 1}};
const FormatOption kCecSign{
    .name = "cec-sign",
    .help = "whether the control subtracts or adds a CEC value; default: subtracts, as with encoder values",
    .fallback = "subtracts",
    .words = {"subtracts", "adds"}};

}  // namespace

Result<ControllerExport> siemens_export(const ExportSource& source, const SiemensOptions& options) {
  ECS_DO(check_exportable(source.map));
  ControllerExport made;
  SiemensPositioning positioning = positioning_of(source, options);
  const std::vector<SiemensGroup> groups = chosen(source, options, positioning.reversal, made);
  if (positioning.encoder.empty() && groups.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning, straightness or squareness of the machine's axes");
  std::vector<Component> carried;
  made.tables = positioning.reports;
  for (const SiemensTable& table : positioning.encoder) carried.push_back(table.component);
  for (const SiemensGroup& group : groups) {
    carried.push_back(*component_of(group.report.component));
    if (group.square) carried.push_back(*group.square);
    made.tables.push_back(group.report);
  }
  if (!positioning.encoder.empty()) made.files.push_back({kEncoderFile, encoder_text(positioning.encoder, options)});
  if (!groups.empty()) made.files.push_back({kCrossFile, cross_text(all_tables(groups), options)});
  add_settings(made, positioning.encoder, groups, options);
  leave_behind(made, source, carried, "cannot be corrected by a table, which has no lever arm", kTooFew);
  bool travels_known = true;
  for (const Axis axis : kAllAxes)
    travels_known = travels_known && (!has_axis(source, axis) || source.travel_mm[index_of(axis)]);
  for (LeftBehind& left : made.not_carried)
    if (const auto component = component_of(left.what); component && is_squareness(*component) && !travels_known)
      left.why = "needs the travels of all axes: give --machine";
  made.notes.push_back("changing MD18342 or MD38000 reformats the memory of the control: save its data first");
  made.notes.push_back(
      "signs: the manual gives that of ENC_COMP; that of CEC is assumed to be the same. Check one CEC table on the "
      "machine. If its sign is wrong, export again with `--cec-sign adds` (modules/controllers/README.md)");
  ECS_DO(take_back(made, options));
  return made;
}

extern const ControllerFormat siemens_format{
    .id = "siemens",
    .title = "SINUMERIK 840D",
    .name = "SINUMERIK",
    .summary =
        "SINUMERIK 840D: encoder error tables, and cross-axis (CEC) tables for straightness, squareness and reversal "
        "error",
    .example = "ecs export siemens map.csv --params mill.toml --points 200 --tables 8 -o sinumerik/",
    .output_help = "folder for AX_EEC.INI and NC_CEC.INI",
    .marks = "$AA_ENC_COMP or $AN_CEC",
    .place = 20,
    .holds = {"yes", "yes, two tables an axis", "yes, two tables each", "yes, a line each", "–",
              "even; MD38000, MD18342 (828D: 200 points, 8 tables)"},
    .resolution_um = 0.001,
    .tables_add_up = true,
    .write_options = {kAxesOption,
                      kEncoder,
                      kCecSign,
                      {.name = "points",
                       .help = "maximum number of points of a table; default 1000, 828D has 200",
                       .fallback = "1000",
                       .range = IntegerRange{2, 5000}},
                      {.name = "tables",
                       .help = "maximum number of cross-axis (CEC) tables; default 62, 828D has 8",
                       .fallback = "62",
                       .range = IntegerRange{0, 200}}},
    .read_options = {kAxesOption, kEncoder, kCecSign},
    .is_file = [](std::string_view name) { return name == kEncoderFile || name == kCrossFile; },
    .recognises = has_siemens_tables,
    .write = write_siemens,
    .read = read_siemens,
};

}  // namespace ecs::controllers
