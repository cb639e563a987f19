// SINUMERIK 840D: what a map becomes within the tables that the control has.
// (siemens_groups.cpp), their text (siemens_text.cpp), reading (siemens_reader.cpp).
#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "controllers/format.hpp"
#include "controllers/siemens_tables.hpp"

namespace ecs::controllers {
namespace {

constexpr const char* kEncoderFile = "AX_EEC.INI";
constexpr const char* kCrossFile = "NC_CEC.INI";

std::size_t tables_in(const std::vector<SiemensGroup>& groups) {
  std::size_t count = 0;
  for (const SiemensGroup& group : groups) count += group.tables.size();
  return count;
}

const char* const kTooFew = "more cross tables would be needed than the control has";

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
  std::stable_sort(all.begin(), all.end(), [](const Upgrade& a, const Upgrade& b) {
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
    groups.erase(std::min_element(groups.begin(), groups.end(), [](const SiemensGroup& a, const SiemensGroup& b) {
      return a.largest() < b.largest();
    }));
  for (Upgrade& upgrade : upgrades_of(source, options, reversal)) {
    const bool beside = upgrade.cost == 2;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const SiemensGroup& group) {
      return group.report.component == upgrade.with.report.component;
    });
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
  made.notes.push_back(
      fmt::format("{} cross tables would be needed, the control has {}: squareness is inside the straightness tables "
                  "of the same axes, and only the largest reversals have their two directions",
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
      made.settings.push_back(
          fmt::format("MD32720 $MA_CEC_MAX_SUM[{}] of at least {:.3f} mm", name, sum_um[index_of(axis)] / kUmPerMm));
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
  return !name.empty() && name.size() <= kLongest && std::all_of(name.begin(), name.end(), fits);
}

Result<SiemensOptions> siemens_options(const OptionValues& values) {
  SiemensOptions options;
  const std::string_view axes = values.text("axes");
  options.encoder = values.integer("encoder");
  options.cec_adds = values.text("cec-sign") == "adds";
  for (const auto& [axis, name] : axis_pairs(axes)) {
    if (!axis || !is_axis_name(name))
      return problem(ProblemKind::usage,
                     fmt::format("--axes: expected X=NAME,Y=NAME,Z=NAME, as in X=AX1, found \"{}\"", axes));
    options.axis_name[index_of(*axis)] = std::string(name);
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && lower(options.axis_name[index_of(a)]) == lower(options.axis_name[index_of(b)]))
        return problem(ProblemKind::usage, fmt::format("--axes: {} and {} have the same name {}", letter_of(a),
                                                       letter_of(b), options.axis_name[index_of(a)]));
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

const FormatOption kAxes{.name = "axes", .help = "axes of the control; default X=AX1,Y=AX2,Z=AX3"};
const FormatOption kEncoder{.name = "encoder",
                            .help = "measuring system 0 or 1 of $AA_ENC_COMP; default 0",
                            .fallback = "0",
                            .range = IntegerRange{0, 1}};
const FormatOption kCecSign{
    .name = "cec-sign",
    .help = "what the control does with a cross value; default subtracts, as it does with encoder values",
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
  leave_behind(made, source, carried, "a table has no lever arm", kTooFew);
  made.notes.push_back("changing MD18342 or MD38000 reformats the memory of the control: save its data first");
  made.notes.push_back(
      "signs: the manual prints that of ENC_COMP; that of CEC is taken to be the same. Check one CEC "
      "table on the machine; --cec-sign adds writes the other (docs/controllers.md)");
  ECS_DO(take_back(made, options));
  return made;
}

bool is_siemens_file(std::string_view name) { return name == kEncoderFile || name == kCrossFile; }

extern const ControllerFormat kSiemens{
    .id = "siemens",
    .title = "SINUMERIK 840D",
    .name = "SINUMERIK",
    .summary = "SINUMERIK 840D: encoder error tables, and cross tables for straightness, squareness and reversal",
    .example = "ecs export siemens map.csv --params mill.toml --points 200 --tables 8 -o sinumerik/",
    .output_help = "folder for AX_EEC.INI and NC_CEC.INI",
    .marks = "$AA_ENC_COMP or $AN_CEC",
    .holds = {"yes", "yes, two tables an axis", "yes, two tables each", "yes, a line each", "–",
              "even; MD38000, MD18342 (828D: 200 points, 8 tables)"},
    .resolution_um = 0.001,
    .tables_add_up = true,
    .write_options = {kAxes,
                      kEncoder,
                      kCecSign,
                      {.name = "points",
                       .help = "most points of a table; default 1000, 828D has 200",
                       .fallback = "1000",
                       .range = IntegerRange{2, 5000}},
                      {.name = "tables",
                       .help = "most cross tables; default 62, 828D has 8",
                       .fallback = "62",
                       .range = IntegerRange{0, 200}}},
    .read_options = {kAxes, kEncoder, kCecSign},
    .is_file = is_siemens_file,
    .recognises = has_siemens_tables,
    .write = write_siemens,
    .read = read_siemens,
};

}  // namespace ecs::controllers
