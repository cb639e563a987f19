// The Etalon exchange format, writing and reading.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

/// Terms that lever over a coordinate, of one moving axis and observed direction.
std::vector<Term> levers_of(const TermTable& terms, Component translation) {
  std::vector<Term> rows;
  for (const Term& term : terms)
    if (term.has_lever && term.uses_coordinate && !is_squareness(term.component) &&
        moving_axis(term.component) == moving_axis(translation) && term.observed == direction_of(sense_of(translation)))
      rows.push_back(term);
  return rows;
}

/// A translation measured on its line, brought to where the lever arms are zero (`way` −1), or back (+1).
/// E = δ + ε·(L − line) = (δ − ε·line) + ε·L. @param scale  of the angles in `map`
ControlCurve moved(const laser::ErrorMap& map, const MeasurementLines& lines, const TermTable& terms,
                   Component translation, ControlCurve curve, double way, double scale) {
  const Axis axis = moving_axis(translation);
  for (const Term& term : levers_of(terms, translation)) {
    const double line_m = lines[index_of(axis)][index_of(term.lever)] / 1000.0;
    const auto angle = curve_of(map, term.component);
    if (!angle || line_m == 0.0) continue;
    std::set<double> positions(curve.position_mm.begin(), curve.position_mm.end());
    positions.insert(angle->position_mm.begin(), angle->position_mm.end());
    curve = resampled(curve, {positions.begin(), positions.end()});
    const double weight = way * term.sign * scale * line_m;
    for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
      curve.forward[i] += weight * value_at(*angle, Approach::forward, curve.position_mm[i]);
      curve.reverse[i] += weight * value_at(*angle, Approach::reverse, curve.position_mm[i]);
    }
  }
  return curve;
}

const ControlCurve kNoCurve{{0.0}, {0.0}, {0.0}};  ///< nothing measured, yet rotations may act on the measurement line

/// The translation of a map, moved; nothing if it has none and no rotation makes one.
std::optional<ControlCurve> moved_curve(const laser::ErrorMap& map, const MeasurementLines& lines,
                                        const TermTable& terms, Component translation, double way, double scale) {
  const auto curve = curve_of(map, translation);
  ControlCurve made = moved(map, lines, terms, translation, curve.value_or(kNoCurve), way, scale);
  if (!curve && made.position_mm.size() < 2) return std::nullopt;
  return made;
}

constexpr int kPositionDigits = 6;  ///< of mm: one nanometre
constexpr int kLengthDigits = 8;    ///< of mm
constexpr int kAngleDigits = 11;    ///< of rad

double as_written(double value, int digits) { return number_in(fixed_text(value, digits)).value_or(value); }

int digits_of(Component component) { return is_angular(component) ? kAngleDigits : kLengthDigits; }

/// The curve in the digits of the file. @param scale  of its values there
ControlCurve in_digits(const ControlCurve& curve, Component component, double scale) {
  return as_in_file(
      curve, [](double place_mm) { return as_written(place_mm, kPositionDigits); },
      [&](double value) { return scale == 0.0 ? value : as_written(value * scale, digits_of(component)) / scale; });
}

std::string function_text(Component component, const ControlCurve& curve, double scale) {
  std::string text = fmt::format("[{}]\nGridpoints = {{\n", name_of(component));
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    text += fmt::format("{:>14} {:>16}\n", fixed_text(curve.position_mm[i], kPositionDigits),
                        fixed_text(-curve.forward[i] * scale, digits_of(component)));
  return text + fmt::format("}}  // end of {}\n", name_of(component));
}

std::string head_text(const ExportSource& source, const EtalonOptions& options) {
  std::string text = "// Errors = actual - target, mm and rad, ISO 230-1; the control subtracts them.\n";
  if (!source.map.header.machine.empty()) text += fmt::format("// machine: {}\n", source.map.header.machine);
  text += fmt::format("// configuration: {}\n", configuration_of(source.parameters));
  text += fmt::format("// {}\n", options.levers_from_zero ? kLeversFromZero : kLeversFromLines);
  return text + "// Both approaches: the mean. Own-axis levers of workpiece-side axes are inside the curves.\n";
}

/// The curve of a component as the format wants it, both approaches; nothing if there is none to write.
std::optional<ControlCurve> curve_for(const ExportSource& source, const TermTable& terms, Component component,
                                      bool levers_from_zero) {
  const UnitParameters& p = source.parameters;
  if (!has_axis(source, moving_axis(component))) return std::nullopt;
  if (is_angular(component) || !levers_from_zero) return curve_of(source.map, component);
  return moved_curve(source.map, p.measurement_lines_mm, terms, component, -1.0, p.angular_scale);
}

/// Adds the functions of all curves to file and report. @return the largest half reversal of a translation [um]
double add_functions(const ExportSource& source, const TermTable& terms, const EtalonOptions& options,
                     ControllerExport& made, std::string& text) {
  double reversal_um = 0.0;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto component = static_cast<Component>(i);
    const auto curve = curve_for(source, terms, component, options.levers_from_zero);
    if (!curve) continue;
    const ControlCurve whole = mean_of(*curve);
    const double scale = is_angular(component) ? kRadPerUmPerM * source.parameters.angular_scale : 1.0 / kUmPerMm;
    const ControlCurve kept =
        in_digits(options.most_points >= 2 ? thinned(whole, options.most_points) : whole, component, scale);
    ExportedTable report{
        std::string(name_of(component)), "function", whole.position_mm.size(), kept.position_mm.size(), 0.0, 0.0, 0.0};
    for (const double value : kept.forward) report.largest = std::max(report.largest, std::abs(value));
    for (std::size_t k = 0; k < curve->position_mm.size(); ++k) {
      const double written = value_at(kept, Approach::forward, curve->position_mm[k]);
      for (const double measured : {curve->forward[k], curve->reverse[k]})
        report.deviation = std::max(report.deviation, std::abs(written - measured));
      if (!is_angular(component))
        reversal_um = std::max(reversal_um, 0.5 * std::abs(curve->forward[k] - curve->reverse[k]));
    }
    text += function_text(component, kept, scale);
    report.unit = unit_of(component);
    made.tables.push_back(std::move(report));
  }
  return reversal_um;
}

void add_squareness(const UnitParameters& parameters, ControllerExport& made, std::string& text) {
  const auto squareness = squareness_of(parameters);
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z}) {
    const double value = squareness[index_of(square)];
    if (value == 0.0) continue;
    text += fmt::format("[{}]\nVALUE = {}\n", name_of(square), fixed_text(value * kRadPerUmPerM, 11));
    made.tables.push_back({std::string(name_of(square)), "value", 1, 1, std::abs(value), 0.0, 0.0, "um/m"});
  }
}

void say_what_is_lost(const ExportSource& source, double reversal_um, ControllerExport& made) {
  std::vector<Component> carried;
  for (const ExportedTable& table : made.tables) carried.push_back(*component_of(table.component));
  if (reversal_um > 0.0005)
    made.not_carried.push_back(
        {"half the reversal", reversal_um, "um", "the format has one function for both approaches, the mean"});
  const std::string no_axis = "the machine does not have this axis";
  leave_behind(made, source, carried, no_axis, no_axis);
}

Result<ControllerExport> write_etalon(const ExportSource& source, const OptionValues& options) {
  return etalon_export(
      source, {"errors.txt", options.text("levers") != "lines", static_cast<std::size_t>(options.integer("points"))});
}

Result<ControllerTables> read_etalon(const ReadRequest& request) {
  return parse_etalon(request.text, request.file_name);
}

bool has_functions(std::string_view text) {
  const auto lines = lines_of(text);
  if (std::ranges::none_of(lines, [](std::string_view line) { return trimmed(line).starts_with('['); })) return false;
  const std::string plain = lower(text);
  return plain.find("gridpoints") != std::string::npos || plain.find("value") != std::string::npos;
}

}  // namespace

std::optional<ControlCurve> curve_at_machine_zero(const ExportSource& source, const TermTable& terms,
                                                  Component component) {
  return curve_for(source, terms, component, true);
}

Result<ControllerExport> etalon_export(const ExportSource& source, const EtalonOptions& options) {
  ECS_DO(check_exportable(source.map));
  ECS_TRY(terms, iso_terms(source.parameters, "the format is"));
  ControllerExport made;
  std::string text = head_text(source, options);
  const double reversal_um = add_functions(source, terms, options, made, text);
  add_squareness(source.parameters, made, text);
  if (made.tables.empty()) return problem(ProblemKind::refused, "the map has no curve of an axis of the machine");
  made.files.push_back({options.file_name, std::move(text)});
  auto again = parse_etalon(made.files.front().content, options.file_name);
  if (!again) return unwritable(again.error());
  made.applied = std::move(*again);
  say_what_is_lost(source, reversal_um, made);
  made.settings = {fmt::format("kinematic chain of the control: {} (tool side after T, workpiece side before it)",
                               configuration_of(source.parameters)),
                   "TwinCAT: vol_comp[i].max_records of at least the number of rows; X, Y and Z are the measured axes"};
  made.notes = {"values are errors; a control that adds them must negate them (TwinCAT: negate)"};
  if (source.parameters.tool_offset_mm != Vector3{})
    made.notes.push_back("the tool offset of the parameters is not in the file: the control adds that of its tool");
  return made;
}

laser::ErrorMap at_measurement_lines(const laser::ErrorMap& read, const UnitParameters& parameters,
                                     bool levers_from_lines) {
  const auto chain = chain_of(parameters);
  if (!chain) return read;
  const TermTable terms = *terms_of(*chain, Convention::iso, CurveKind::measured);
  laser::ErrorMap out;
  out.header = read.header;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto component = static_cast<Component>(i);
    const bool angular = is_angular(component);
    const auto curve = angular || levers_from_lines
                           ? curve_of(read, component)
                           : moved_curve(read, parameters.measurement_lines_mm, terms, component, 1.0, 1.0);
    if (!curve) continue;
    const bool same = curve->forward == curve->reverse;
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      laser::MapTable table{component, same ? Approach::unknown : approach, curve->position_mm,
                            approach == Approach::forward ? curve->forward : curve->reverse};
      if (angular && parameters.angular_scale != 0.0)
        for (double& value : table.compensation) value /= parameters.angular_scale;
      out.tables.push_back(std::move(table));
      if (same) break;
    }
  }
  return out;
}

extern const ControllerFormat etalon_format{
    .id = "etalon",
    .title = "Etalon exchange format",
    .name = "Etalon",
    .summary = "the whole volumetric model in the Etalon exchange format (TwinCAT, ISG)",
    .example = "ecs export etalon map.csv --params mill.toml -o mill_errors.txt",
    .output_help = "file to write",
    .marks = "sections such as [EXX]",
    .place = 30,
    .holds = {"yes", "mean only", "yes", "yes", "yes", "as many as the control accepts"},
    .resolution_um = 0.00001,
    .write_options =
        {{.name = "levers",
          .help = "origin of the lever arms in the control: the machine zero (default), or the measurement lines",
          .fallback = "zero",
          .words = {"zero", "lines"}},
         {.name = "points",
          .help = "maximum number of grid points of a function; default: all points of the map",
          .fallback = "0",
          .range = IntegerRange{2, 1'000'000}}},
    .read_options = {{.name = "levers",
                      .help = "origin of the lever arms; default: as stated in the head of the file, else zero",
                      .words = {"zero", "lines"}}},
    .recognises = has_functions,
    .write = write_etalon,
    .read = read_etalon,
    .at_measurement_lines = at_measurement_lines,
};

namespace {

/// E or a letter of a constant, then two of X Y Z A B C 0: the shape that all names have, rotary axes among them.
bool is_a_name(std::string_view name) {
  if (name.size() != 3) return false;
  const auto among = [](char c, std::string_view set) { return set.find(c) != std::string_view::npos; };
  if (name[0] == 'E') return among(name[1], "XYZABC0") && among(name[2], "XYZABCUVW0");
  return among(name[0], "XYZABC") && name[1] == '0' && among(name[2], "XYZABCUVW");
}

class EtalonReader {
 public:
  explicit EtalonReader(const std::string& file) : findings(file) {}

  void take(std::string_view raw, int number) {
    line_ = number;
    raw_ = raw;
    const std::size_t comment = raw.find("//");
    if (comment != std::string_view::npos) head(trimmed(raw.substr(comment + 2)));
    std::string_view rest = trimmed(raw.substr(0, comment));
    while (!rest.empty()) rest = trimmed(in_grid_ ? grid(rest) : outside(rest));
    if (half_row_) findings.add(number, static_cast<int>(raw.size()) + 1, "expected a value behind the position");
    half_row_.reset();
  }

  void finish() {
    if (in_grid_) findings.add(line_, 0, "the grid points of {} do not end with }}", name_);
    close();
    if (findings.empty() && read.tables.empty() && !any_square_)
      findings.add(0, 0,
                   "no errors of linear axes: expected sections such as [EXX] with Gridpoints, or [C0Y] with VALUE");
  }

  laser::Findings findings;
  ControllerTables read;

 private:
  [[nodiscard]] int column(std::string_view at) const { return static_cast<int>(at.data() - raw_.data()) + 1; }
  /// Where lever arms count from, as our own files say it.
  void head(std::string_view comment) {
    const bool lines = comment == kLeversFromLines;
    if (!lines && comment != kLeversFromZero) return;
    if (read.levers_from_lines && *read.levers_from_lines != lines)
      findings.add(line_, 1,
                   "the file states two origins of its lever arms: the machine zero and the measurement lines");
    read.levers_from_lines = lines;
  }
  void wrong(std::string_view at, std::string_view expected) {
    findings.add(line_, column(at), "expected {}, found {}", expected, laser::in_quotes(at));
  }

  /// A section, VALUE or the beginning of a grid; what is left of the line.
  std::string_view outside(std::string_view text) {
    if (text.front() == '[') {
      const std::size_t end = text.find(']');
      if (end == std::string_view::npos) {
        wrong(text, "a name in brackets, as in [EXX]");
        return {};
      }
      open(text.substr(0, end + 1));
      return text.substr(end + 1);
    }
    if (text.front() == '{' && grid_announced_) {
      grid_announced_ = false;
      in_grid_ = true;
      return text.substr(1);
    }
    const std::string plain = lower(text.substr(0, 10));
    if (plain.starts_with("gridpoints")) {
      grid_announced_ = true;
      return after_equals(text.substr(10));
    }
    if (plain.starts_with("value")) {
      value(after_equals(text.substr(5)));
      return {};
    }
    wrong(text, "[NAME], VALUE = or Gridpoints = {");
    return {};
  }

  static std::string_view after_equals(std::string_view text) {
    text = trimmed(text);
    return text.starts_with('=') ? trimmed(text.substr(1)) : text;
  }

  void open(std::string_view bracketed) {
    close();
    std::string_view inside = trimmed(bracketed.substr(1, bracketed.size() - 2));
    name_ = upper(inside);
    if (!is_a_name(name_)) wrong(bracketed, "a name such as EXX, EAY or C0Y");
    opened_line_ = line_;
    component_ = component_of(name_);
    if (!component_ && is_a_name(name_)) read.notes.push_back(name_ + ": not an error of three linear axes, ignored");
    if (component_ && !named_.insert(*component_).second)
      findings.add(line_, column(bracketed), "{} occurs twice", name_);
  }

  void value(std::string_view text) {
    const auto number = number_in(text);
    if (!number || std::abs(*number) / kRadPerUmPerM > kLargestValue_um * kUmPerMm) return wrong_value(text);
    if (!component_) return;
    if (is_squareness(*component_)) {
      if (std::abs(*number) / kRadPerUmPerM > kLargestValue_um) return wrong_value(text);
      read.squareness[index_of(*component_)] = *number / kRadPerUmPerM;
      any_square_ = true;
    } else if (*number != 0.0) {
      findings.add(line_, 1, "{} varies along its axis: expected Gridpoints", name_);
    }
  }
  void wrong_value(std::string_view text) {
    findings.add(line_, text.empty() ? 0 : column(text), "expected a number, found {}", laser::in_quotes(text));
  }

  /// A word of a row `position value`; what is left of the line. The grid ends at the brace.
  std::string_view grid(std::string_view text) {
    if (text.front() == '}') {
      in_grid_ = false;
      return text.substr(1);
    }
    const std::size_t end = text.find_first_of(" \t,;}");
    if (end == 0) return text.substr(1);
    const std::string_view word = text.substr(0, end);
    const auto number = number_in(word);
    if (!number) {
      wrong(word, "a position and a value with points");
      half_row_.reset();
      return {};
    }
    if (half_row_) {
      points_.push_back({*half_row_, *number, line_});
      half_row_.reset();
    } else {
      half_row_ = *number;
    }
    return end == std::string_view::npos ? std::string_view() : text.substr(end);
  }

  struct Point {
    double position_mm = 0.0, value = 0.0;
    int line = 0;
  };

  /// The section that ends here becomes a table.
  void close() {
    std::vector<Point> points = std::move(points_);
    points_.clear();
    in_grid_ = grid_announced_ = false;
    if (points.empty() || !component_) return;
    if (is_squareness(*component_)) return findings.add(opened_line_, 1, "{} is one VALUE, not grid points", name_);
    if (points.size() > 1 && points.back().position_mm < points.front().position_mm) std::ranges::reverse(points);
    const double scale = is_angular(*component_) ? 1.0 / kRadPerUmPerM : kUmPerMm;
    laser::MapTable table{*component_, Approach::unknown, {}, {}};
    for (const Point& point : points) {
      if (!table.position_mm.empty() && point.position_mm <= table.position_mm.back())
        findings.add(point.line, 0, "{}: the positions do not rise throughout", name_);
      if (std::abs(point.value) * scale > kLargestValue_um || std::abs(point.position_mm) > kLargestPosition_mm)
        findings.add(point.line, 0, "{}: {} at {} is not a plausible error (mm, rad)", name_, point.value,
                     point.position_mm);
      table.position_mm.push_back(point.position_mm);
      table.compensation.push_back(-point.value * scale + 0.0);
    }
    read.tables.push_back(std::move(table));
  }

  int line_ = 0;
  int opened_line_ = 0;
  std::string_view raw_;
  std::string name_;
  std::optional<Component> component_;
  std::set<Component> named_;
  bool in_grid_ = false;
  bool grid_announced_ = false;
  bool any_square_ = false;
  std::optional<double> half_row_;
  std::vector<Point> points_;
};

}  // namespace

Result<ControllerTables> parse_etalon(std::string_view text, const std::string& file_name) {
  EtalonReader reader(file_name);
  for (const NumberedLine& line : numbered_lines_of(text)) reader.take(line.text, line.number);
  reader.finish();
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  const auto add_source = [&](Component component) {
    reader.read.sources.push_back({std::string(name_of(component)), file_name, sha256_hex(text)});
  };
  for (const laser::MapTable& table : reader.read.tables) add_source(table.component);
  return std::move(reader.read);
}

}  // namespace ecs::controllers
