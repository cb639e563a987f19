// HEIDENHAIN, writing and reading.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

/// Entries of COMPTAB that the control takes, MachAxis entries of the kinematics included (manual p. 686).
constexpr int kMostComptab = 100;
constexpr double kDegPerUmPerM = 1e-6 * 180.0 / std::numbers::pi;

/// One column of a table of an axis.
struct ComColumn {
  Component component = Component::EXX;
  std::string heading;
  ControlCurve curve;  ///< compensation, on the positions of the table
};

std::string table_name(Axis axis) { return fmt::format("{}.com", small_letter_of(axis)); }

double unit_in_file(Component component, double angular_scale) {
  return is_angular(component) ? kDegPerUmPerM * angular_scale : 1.0 / kUmPerMm;
}

/// The squareness that tilts the motion of `axis` in direction `to`: error um at 1 m of the axis; 0 where none does.
double slope_um_per_m(const UnitParameters& p, Component straightness) {
  const auto square = square_of(straightness);
  return square ? square->sign * squareness_um_per_m(p, square->component) : 0.0;
}

/// With the tilt of a squareness in a straightness, over the whole travel of the axis.
std::optional<ControlCurve> with_slope(const ExportSource& source, Component component,
                                       std::optional<ControlCurve> curve) {
  const double slope = slope_um_per_m(source.parameters, component);
  const Axis axis = moving_axis(component);
  if (slope == 0.0 || !has_axis(source, axis) || !has_axis(source, direction_of(sense_of(component)))) return curve;
  std::set<double> positions;
  if (curve) positions.insert(curve->position_mm.begin(), curve->position_mm.end());
  if (const auto& travel = source.travel_mm[index_of(axis)]) positions.insert(travel->begin(), travel->end());
  if (positions.size() < 2) return curve;
  const ControlCurve level{{0.0}, {0.0}, {0.0}};
  ControlCurve tilted = resampled(curve.value_or(level), {positions.begin(), positions.end()});
  for (std::size_t i = 0; i < tilted.position_mm.size(); ++i) {
    const double compensation_um = -slope * tilted.position_mm[i] / 1000.0;
    tilted.forward[i] += compensation_um;
    tilted.reverse[i] += compensation_um;
  }
  return tilted;
}

std::vector<ComColumn> columns_for(const ExportSource& source, const TermTable& terms, Axis axis,
                                   const HeidenhainOptions& options) {
  std::vector<ComColumn> columns;
  for (std::size_t i = 0; i < kHeidenhainColumns; ++i) {
    const Component component = curve_of(static_cast<Sense>(i), axis);
    const bool rotation = is_angular(component);
    if (rotation && !options.kinematics) continue;
    auto curve = options.kinematics && options.levers_from_zero ? curve_at_machine_zero(source, terms, component)
                                                                : curve_of(source.map, component);
    curve = with_slope(source, component, std::move(curve));
    if (!curve || (largest_in(*curve) == 0.0 && !is_positioning(component))) continue;
    const bool in_axis_column = !options.kinematics || is_positioning(component);
    if (!is_positioning(component)) curve = mean_of(*curve);
    columns.push_back(
        {component,
         in_axis_column ? std::string(1, letter_of(direction_of(sense_of(component)))) : fmt::format("C{}", i + 1),
         std::move(*curve)});
  }
  return columns;
}

/// Largest miss of any column between the points, in parts of the largest value of that column.
double largest_miss(const std::vector<ComColumn>& columns, const std::vector<double>& position_mm) {
  double worst = 0.0;
  for (const ComColumn& column : columns) {
    const ControlCurve coarse = resampled(column.curve, position_mm);
    const double largest = std::max(largest_in(column.curve), 1e-9);
    for (std::size_t i = 0; i < column.curve.position_mm.size(); ++i) {
      const double p = column.curve.position_mm[i];
      worst = std::max({worst, std::abs(value_at(coarse, Approach::forward, p) - column.curve.forward[i]) / largest,
                        std::abs(value_at(coarse, Approach::reverse, p) - column.curve.reverse[i]) / largest});
    }
  }
  return worst;
}

/// One set of positions for all columns: all of them, or of the sets that suit one column best the one that suits all.
std::vector<double> common_positions(const std::vector<ComColumn>& columns, std::size_t most) {
  std::set<double> all;
  for (const ComColumn& column : columns) all.insert(column.curve.position_mm.begin(), column.curve.position_mm.end());
  std::vector<double> best(all.begin(), all.end());
  if (best.size() <= most) return best;
  double least = 0.0;
  bool found = false;
  for (const ComColumn& column : columns) {
    const std::vector<double> chosen = thinned(resampled(column.curve, {all.begin(), all.end()}), most).position_mm;
    const double miss = largest_miss(columns, chosen);
    if (found && miss >= least) continue;
    best = chosen;
    least = miss;
    found = true;
  }
  return best;
}

std::string com_number(double value, int digits) {
  const std::string text = fmt::format("{:+.{}f}", value, digits);
  return text.find_first_not_of("+-0.") == std::string::npos ? fmt::format("+{:.{}f}", 0.0, digits) : text;
}

constexpr int kPositionInFile = 6;  ///< digits of mm: one nanometre

/// In the digits of the file; of positions that fall together the first.
std::vector<double> as_in_file(const std::vector<double>& position_mm) {
  std::vector<double> kept;
  for (const double p : position_mm) {
    const double written = number_in(com_number(p, kPositionInFile)).value_or(p);
    if (kept.empty() || written > kept.back()) kept.push_back(written);
  }
  return kept;
}

constexpr int kCell = 14;

std::string com_text(Axis axis, const std::vector<ComColumn>& columns, const HeidenhainOptions& options,
                     double angular_scale) {
  std::string text =
      fmt::format("BEGIN {} MM\n{:<5}{:<{}}{:<{}}", upper(table_name(axis)), "NR", "AXISPOS", kCell, "BACKLASH", kCell);
  for (const ComColumn& column : columns) text += fmt::format("{:<{}}", column.heading, kCell);
  text += '\n';
  const double sign = options.holds_errors ? -1.0 : 1.0;
  for (std::size_t i = 0; i < columns.front().curve.position_mm.size(); ++i) {
    std::string backlash, values;
    for (const ComColumn& column : columns) {
      const double unit = sign * unit_in_file(column.component, angular_scale);
      const int digits = is_angular(column.component) ? kHeidenhainAngleDigits : kHeidenhainLengthDigits;
      const std::string forward = com_number(column.curve.forward[i] * unit, digits);
      if (is_positioning(column.component) && column.curve.forward != column.curve.reverse)
        backlash = com_number(column.curve.reverse[i] * unit, digits);
      values += fmt::format("{:<{}}", forward, kCell);
    }
    text += fmt::format("{:<5}{:<{}}{:<{}}{}\n", i, com_number(columns.front().curve.position_mm[i], kPositionInFile),
                        kCell, backlash, kCell, values);
  }
  return text + "[END]\n";
}

std::string cma_text(const std::vector<Axis>& axes) {
  std::string heading = fmt::format("{:<5}{:<8}", "NR", "ACTIVE"), row = fmt::format("{:<5}{:<8}", 0, "*");
  for (const Axis axis : axes) {
    heading += fmt::format("{:<{}}", letter_of(axis), kCell);
    row += fmt::format("{:<{}}", table_name(axis), kCell);
  }
  return fmt::format("BEGIN CONFIG.CMA MM\n{}\n{}\n[END]\n", heading, row);
}

/// The entries of the kinematics table for the columns C2 … of an axis. @return how many
int add_kinematics_entries(Axis axis, const std::vector<ComColumn>& columns, ControllerExport& made) {
  std::vector<std::string> entries;
  for (const ComColumn& column : columns)
    if (column.heading.starts_with('C'))
      entries.push_back(fmt::format("Trans {} with {} ({}) in COMPTAB",
                                    "XYZABC"[static_cast<std::size_t>(sense_of(column.component))], column.heading,
                                    name_of(column.component)));
  if (!entries.empty())
    made.settings.push_back(
        fmt::format("kinematics table: insert above the line MachAxis {}: {}, each with the table {}", letter_of(axis),
                    fmt::join(entries, ", "), table_name(axis)));
  return static_cast<int>(entries.size());
}

void report_columns(const ExportSource& source, const std::vector<ComColumn>& whole,
                    const std::vector<ComColumn>& columns, const ControllerTables& again, const std::string& file,
                    ControllerExport& made) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Component component = columns[c].component;
    laser::ErrorMap written_map;
    for (const laser::MapTable& table : again.tables)
      if (table.component == component) written_map.tables.push_back(table);
    const auto written = curve_of(written_map, component);
    if (!written) continue;
    const double scale =
        is_angular(component) && source.parameters.angular_scale != 0.0 ? source.parameters.angular_scale : 1.0;
    double deviation = 0.0;
    for (std::size_t i = 0; i < whole[c].curve.position_mm.size(); ++i) {
      const double p = whole[c].curve.position_mm[i];
      for (const Approach approach : {Approach::forward, Approach::reverse})
        deviation = std::max(deviation,
                             std::abs(value_at(*written, approach, p) / scale - value_at(whole[c].curve, approach, p)));
    }
    made.tables.push_back({std::string(name_of(component)), fmt::format("{}, column {}", file, columns[c].heading),
                           whole[c].curve.position_mm.size(), written->position_mm.size(), largest_in(*written),
                           deviation, 0.0, std::string(unit_of(component))});
  }
}

/// What a mean of both approaches loses, of all but positioning.
double lost_reversal(const ExportSource& source, const std::vector<Component>& carried, bool rotations) {
  double lost = 0.0;
  for (const Component component : carried) {
    if (is_squareness(component) || is_positioning(component) || is_angular(component) != rotations) continue;
    if (const auto curve = curve_of(source.map, component)) lost = std::max(lost, 0.5 * largest_reversal(*curve));
  }
  return lost;
}

std::vector<Component> with_squareness(const UnitParameters& p, std::vector<Component> carried) {
  for (const Component straightness : std::vector<Component>(carried))
    if (slope_um_per_m(p, straightness) != 0.0) carried.push_back(square_of(straightness)->component);
  return carried;
}

Result<ControllerExport> write_heidenhain(const ExportSource& source, const OptionValues& options) {
  return heidenhain_export(
      source, {options.text("tables") != "plain", options.text("com-sign") != "adds", options.text("levers") != "lines",
               static_cast<std::size_t>(options.integer("points")), std::nullopt});
}

Result<ControllerTables> read_heidenhain(const ReadRequest& request) {
  ECS_TRY(axis, axis_option(request));
  HeidenhainOptions options;
  options.holds_errors = request.options.text("com-sign") != "adds";
  options.axis = axis;
  return parse_heidenhain(request.text, request.file_name, options);
}

bool is_heidenhain_file(std::string_view name) {
  return name == "config.cma" || std::ranges::any_of(kAllAxes, [&](Axis axis) { return name == table_name(axis); });
}

/// BEGIN, then a name that ends in .COM or .CMA.
bool begins_as_table(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    const std::string content = lower(trimmed(line));
    if (content.empty()) continue;
    return content.starts_with("begin ") &&
           (content.find(".com") != std::string::npos || content.find(".cma") != std::string::npos);
  }
  return false;
}

}  // namespace

Result<ControllerExport> heidenhain_export(const ExportSource& source, const HeidenhainOptions& options) {
  ECS_DO(check_exportable(source.map));
  ECS_TRY(terms, iso_terms(source.parameters, "the tables are named after"));
  ControllerExport made;
  std::vector<Component> carried;
  std::vector<Axis> axes;
  int entries = 0, machine_axes = 0;
  for (const Axis axis : kAllAxes) {
    if (!has_axis(source, axis)) continue;
    ++machine_axes;
    const std::vector<ComColumn> whole = columns_for(source, terms, axis, options);
    if (whole.empty()) continue;
    std::vector<ComColumn> columns = whole;
    const std::vector<double> positions = as_in_file(common_positions(whole, options.most_points));
    for (ComColumn& column : columns) column.curve = resampled(column.curve, positions);
    const std::string name = table_name(axis);
    made.files.push_back({name, com_text(axis, columns, options, source.parameters.angular_scale)});
    HeidenhainOptions reading = options;
    reading.axis = axis;
    auto again = parse_heidenhain(made.files.back().content, name, reading);
    if (!again) return unwritable(again.error());
    report_columns(source, whole, columns, *again, name, made);
    for (const ComColumn& column : columns) carried.push_back(column.component);
    entries += add_kinematics_entries(axis, columns, made);
    ECS_DO(append(made.applied, std::move(*again), true));
    axes.push_back(axis);
  }
  if (axes.empty()) return problem(ProblemKind::refused, "the map has no curve of an axis of the machine");
  made.files.push_back({"config.cma", cma_text(axes)});
  if (entries > 0)
    made.settings.push_back(
        fmt::format("{} entries in COMPTAB; the control accepts {}, including the {} MachAxis entries", entries,
                    kMostComptab, machine_axes));
  const std::string mean = "a column has one value, the mean";
  if (const double lost = lost_reversal(source, carried, false); lost > 0.0005)
    made.not_carried.push_back({"half the reversal of straightness", lost, "um", mean});
  if (const double lost = lost_reversal(source, carried, true); lost > 0.0005)
    made.not_carried.push_back({"half the reversal of rotations", lost, "um/m", mean});
  leave_behind(made, source, with_squareness(source.parameters, carried), "axis columns have no lever arm",
               "the machine does not have this axis");
  made.notes = {
      "values are errors in mm, positive: moved too far. The available pages of the manual state neither sign nor unit "
      "of the columns C4 to C6 (rotations EA, EB, EC); degrees are assumed: try one table first "
      "(modules/controllers/README.md)",
      "squareness is a slope of the straightness columns",
      "the columns of the tables must be those of the axis list of the control"};
  if (source.parameters.tool_offset_mm != Vector3{})
    made.notes.push_back("the tool offset of the parameters is not in the files: the control adds that of its tool");
  return made;
}

extern const ControllerFormat heidenhain_format{
    .id = "heidenhain",
    .title = "HEIDENHAIN compensation tables",
    .name = "HEIDENHAIN",
    .summary = "compensation-value tables of each axis (.com, .cma), for controls with or without KinematicsComp",
    .example = "ecs export heidenhain map.csv --params mill.toml -o heidenhain/",
    .output_help = "folder for x.com, y.com, z.com and config.cma",
    .marks = "a first line BEGIN NAME.COM",
    .place = 50,
    .holds = {"yes", "yes, by position", "yes, the mean", "yes, as a slope", "yes (KinematicsComp)",
              "256 a table, anywhere"},
    .resolution_um = 0.1,
    .write_options =
        {{.name = "tables",
          .help =
              "kinematics: straightness and rotations in columns of their own, for KinematicsComp (default); plain: "
              "straightness in the columns of the other axes, without rotations",
          .fallback = "kinematics",
          .words = {"kinematics", "plain"}},
         {.name = "com-sign",
          .help = "whether the control subtracts a value (default: the values are errors) or adds it",
          .fallback = "subtracts",
          .words = {"subtracts", "adds"}},
         {.name = "levers",
          .help = "origin of the lever arms in the control: the machine zero (default), or the measurement lines",
          .fallback = "zero",
          .words = {"zero", "lines"}},
         {.name = "points",
          .help = "maximum number of points of a table",
          .fallback = "256",
          .range = IntegerRange{2, 100'000}}},
    .read_options = {{.name = "axis", .help = "axis; default: from the name of the table"},
                     {.name = "com-sign",
                      .help = "whether the control subtracts or adds a value; default: subtracts",
                      .fallback = "subtracts",
                      .words = {"subtracts", "adds"}},
                     {.name = "levers", .help = "origin of the lever arms; default: zero", .words = {"zero", "lines"}}},
    .is_file = is_heidenhain_file,
    .recognises = begins_as_table,
    .write = write_heidenhain,
    .read = read_heidenhain,
    .at_measurement_lines = at_measurement_lines,
};

namespace {

constexpr double kUmPerMPerDeg = 1e6 * std::numbers::pi / 180.0;

struct ComHeading {
  std::string name;
  std::size_t begin = 0;
  std::optional<Component> component;  ///< none: NR, AXISPOS, BACKLASH, or nothing of ours
};

/// The axis that the name of a table ends in: "X.COM", "AXIS_X.COM", "axis-y.com".
std::optional<Axis> axis_of_table(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  if (stem.empty()) return std::nullopt;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (stem.size() > 1 && is_letter(stem[stem.size() - 2])) return std::nullopt;
  return axis_of(static_cast<char>(stem.back() & ~0x20));
}

class ComReader {
 public:
  ComReader(const std::string& file, const HeidenhainOptions& options)
      : findings(file), file_(file), options_(options) {}

  void take(std::string_view line, int number) {
    if (ended_ || trimmed(line).empty()) return;
    if (!begun_) return begin(trimmed(line), number);
    if (headings_.empty() && !is_list_) return heading(line, number);
    if (trimmed(line) == "[END]") {
      ended_ = true;
      return;
    }
    if (!is_list_) row(line, number);
  }

  [[nodiscard]] bool is_list() const { return is_list_; }

  ControllerTables finish(std::string_view text) {
    ControllerTables read;
    if (!begun_) findings.add(1, 1, "expected a first line such as BEGIN X.COM MM");
    if (begun_ && !is_list_ && findings.empty()) {
      if (!ended_)
        findings.add(0, 0, "expected [END] behind the last row, found the end of the file: was it truncated?");
      if (position_mm_.size() < 2) findings.add(0, 0, "expected two rows at least");
    }
    if (!findings.empty()) return read;
    if (is_list_) {
      read.notes.push_back(file_ + " is the list of the tables and contains no values: read the .com files");
      return read;
    }
    for (std::size_t h = 0; h < headings_.size(); ++h) add_tables(read, h);
    if (read.tables.empty()) findings.add(0, 0, "no column of X, Y, Z or C1 to C6 has values");
    const std::string what = read.tables.empty() ? "" : std::string(name_of(read.tables.front().component));
    read.sources.push_back({what, file_, sha256_hex(text)});
    return read;
  }

  laser::Findings findings;

 private:
  void begin(std::string_view line, int number) {
    const std::string plain = lower(line);
    begun_ = true;
    if (!plain.starts_with("begin ") ||
        (plain.find(".com") == std::string::npos && plain.find(".cma") == std::string::npos))
      return findings.add(number, 1, "expected BEGIN NAME.COM MM, found {}", laser::in_quotes(line));
    is_list_ = plain.find(".cma") != std::string::npos;
    if (is_list_) return;
    if (plain.find("datum:") != std::string::npos || plain.find("distance:") != std::string::npos)
      return findings.add(number, 1,
                          "tables with DATUM and DISTANCE are not read: the layout of their rows is not known");
    if (plain.ends_with(" inch")) return findings.add(number, 1, "expected MM, found INCH");
    const std::string_view rest = trimmed(line.substr(6));
    const auto by_name = axis_of_table(std::string(rest.substr(0, rest.find(' '))));
    axis_ = options_.axis ? options_.axis : by_name ? by_name : axis_of_table(file_);
    if (!axis_) findings.add(number, 7, "the name of the table does not end in X, Y or Z: give --axis");
  }

  void heading(std::string_view line, int number) {
    for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
      headings_.push_back({std::string(line.substr(at, end - at)), at, std::nullopt});
      at = line.find_first_not_of(" \t\r", end);
    }
    values_.resize(headings_.size());
    for (std::size_t h = 0; h < headings_.size(); ++h) {
      ComHeading& one = headings_[h];
      const std::string name = lower(one.name);
      if (name == "axispos") place_ = h;
      if (name == "backlash") backlash_ = h;
      if (!axis_) continue;
      if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z')
        one.component = curve_of(static_cast<Sense>(name[0] - 'x'), *axis_);
      if (name.size() == 2 && name[0] == 'c' && name[1] >= '1' && name[1] <= '6')
        one.component = curve_of(static_cast<Sense>(name[1] - '1'), *axis_);
    }
    if (!place_) findings.add(number, 1, "expected a column AXISPOS");
  }

  /// The cells of a line, each under its heading.
  void row(std::string_view line, int number) {
    std::optional<double> place, backlash;
    std::vector<std::optional<double>> cells(headings_.size());
    for (std::size_t h = 0; h < headings_.size(); ++h) {
      const std::size_t from = h == 0 ? 0 : headings_[h].begin;
      const std::size_t to = h + 1 < headings_.size() ? headings_[h + 1].begin : line.size();
      const std::string_view cell = from < line.size() ? trimmed(line.substr(from, to - std::min(from, to))) : "";
      if (cell.empty() || (!headings_[h].component && h != place_ && h != backlash_)) continue;
      const auto value = number_in(cell);
      if (!value) {
        findings.add(number, laser::column_of(line, cell), "{}: expected a number under its heading, found {}",
                     headings_[h].name, laser::in_quotes(cell));
        continue;
      }
      (h == place_ ? place : h == backlash_ ? backlash : cells[h]) = *value;
    }
    if (!place) return findings.add(number, 1, "expected a position in the column AXISPOS");
    if (std::abs(*place) > kLargestPosition_mm)
      return findings.add(number, 1, "{} mm is not a plausible position", *place);
    if (!position_mm_.empty() && *place <= position_mm_.back())
      return findings.add(number, 1, "expected a position above {}, found {}", position_mm_.back(), *place);
    position_mm_.push_back(*place);
    lines_.push_back(number);
    backlashes_.push_back(backlash);
    for (std::size_t h = 0; h < headings_.size(); ++h) values_[h].push_back(cells[h]);
  }

  [[nodiscard]] double compensation(double value, Component component, int line) {
    const double sign = options_.holds_errors ? -1.0 : 1.0;
    const double out = sign * value * (is_angular(component) ? kUmPerMPerDeg : kUmPerMm);
    if (!(std::abs(out) <= kLargestValue_um))
      findings.add(line, 1, "a compensation of {:.6g} is implausibly large. Is the file in mm and degrees?", out);
    return out;
  }

  /// Those of one column; an empty cell between others is a gap in the table.
  void add_tables(ControllerTables& read, std::size_t h) {
    if (!headings_[h].component) return;
    const Component component = *headings_[h].component;
    const std::vector<std::optional<double>>& cells = values_[h];
    if (std::ranges::none_of(cells, [](const auto& cell) { return cell.has_value(); })) {
      if (is_positioning(component) && headings_[h].name.size() == 1 && any_backlash())
        findings.add(lines_.front(), 1, "BACKLASH has values, the column of the axis has none");
      return;
    }
    const bool own = is_positioning(component) && any_backlash();
    laser::MapTable forward{component, own ? Approach::forward : Approach::unknown, {}, {}};
    laser::MapTable reverse{component, Approach::reverse, {}, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!cells[i]) continue;
      forward.position_mm.push_back(position_mm_[i]);
      forward.compensation.push_back(compensation(*cells[i], component, lines_[i]));
      reverse.compensation.push_back(compensation(backlashes_[i].value_or(*cells[i]), component, lines_[i]));
    }
    reverse.position_mm = forward.position_mm;
    for (const laser::MapTable& other : read.tables)
      if (other.component == component)
        return findings.add(0, 0, "{} is in an axis column and in a column of KinematicsComp", name_of(component));
    if (forward.position_mm.size() < 2)
      return findings.add(lines_.front(), 1, "{}: expected two values at least", headings_[h].name);
    read.tables.push_back(std::move(forward));
    if (own) read.tables.push_back(std::move(reverse));
  }

  [[nodiscard]] bool any_backlash() const {
    return std::ranges::any_of(backlashes_, [](const auto& one) { return one.has_value(); });
  }

  std::string file_;
  HeidenhainOptions options_;
  bool begun_ = false, ended_ = false, is_list_ = false;
  std::optional<Axis> axis_;
  std::vector<ComHeading> headings_;
  std::optional<std::size_t> place_, backlash_;
  std::vector<double> position_mm_;
  std::vector<int> lines_;
  std::vector<std::optional<double>> backlashes_;
  std::vector<std::vector<std::optional<double>>> values_;  ///< by column
};

}  // namespace

Result<ControllerTables> parse_heidenhain(std::string_view text, const std::string& file_name,
                                          const HeidenhainOptions& options) {
  ComReader reader(file_name, options);
  for (const NumberedLine& line : numbered_lines_of(text)) reader.take(line.text, line.number);
  ControllerTables read = reader.finish(text);
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  return read;
}

}  // namespace ecs::controllers
