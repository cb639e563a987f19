// LinuxCNC: writing, and reading: what a file means, and where LinuxCNC itself would not follow.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

double mm_per_unit(MachineUnits units) { return units == MachineUnits::inch ? kMmPerInch : 1.0; }

/// One nanometre or finer in either unit.
std::string rows_text(const ControlCurve& curve, const LinuxCncOptions& options) {
  const int digits = options.units == MachineUnits::inch ? 8 : 6;
  const double to_units = 1.0 / mm_per_unit(options.units);
  std::string text, last;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
    const double nominal = curve.position_mm[i] * to_units;
    std::string place = fmt::format("{:.{}f}", nominal, digits);
    if (place == last) continue;  // closer than the last digit: not increasing any more
    const double written = number_in(place).value_or(nominal);
    const auto column = [&](double trim_um) {
      const double trim = trim_um / kUmPerMm * to_units;
      return options.type == 0 ? written - trim : trim;
    };
    text +=
        fmt::format("{} {:.{}f} {:.{}f}\n", place, column(curve.forward[i]), digits, column(curve.reverse[i]), digits);
    last = std::move(place);
  }
  return text;
}

/// trivkins numbers the joints in the order of the coordinates.
int joint_of(const UnitParameters& parameters, Axis axis) {
  int joint = 0;
  for (const Axis other : kAllAxes) {
    if (other == axis) break;
    if (parameters.axis_present[index_of(other)]) ++joint;
  }
  return joint;
}

std::string file_of(Axis axis) { return fmt::format("{}.comp", small_letter_of(axis)); }

bool is_linuxcnc_file(std::string_view name) {
  return std::ranges::any_of(kAllAxes, [&](Axis axis) { return name == file_of(axis); });
}

/// What is to be written into the INI file for the joint that moves the axis, each line on its own.
std::vector<std::string> linuxcnc_ini_lines(int joint, const std::string& file_name, int type) {
  return {fmt::format("[JOINT_{}]", joint), fmt::format("COMP_FILE = {}", file_name),
          fmt::format("COMP_FILE_TYPE = {}", type)};
}

MachineUnits units_option(const OptionValues& options) {
  return options.text("units") == "inch" ? MachineUnits::inch : MachineUnits::mm;
}

/// The first line with content begins with a number, and not with two alone, which no row of LinuxCNC has.
bool begins_with_number(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == ';') continue;
    const auto words = blank_words(content);
    return words.size() != 2 && number_in(words.front()).has_value();
  }
  return false;
}

Result<ControllerExport> write_linuxcnc(const ExportSource& source, const OptionValues& options) {
  return linuxcnc_export(
      source, {options.integer("type"), units_option(options), static_cast<std::size_t>(options.integer("points"))});
}

Result<ControllerTables> read_linuxcnc(const ReadRequest& request) {
  ECS_TRY(axis, axis_of_file(request));
  LinuxCncReadOptions options{axis, std::nullopt, units_option(request.options), request.options.flag("as-loaded")};
  if (!request.options.text("type").empty()) options.type = request.options.integer("type");
  return parse_linuxcnc(request.bytes, request.file_name, options);
}

}  // namespace

Result<ControllerExport> linuxcnc_export(const ExportSource& source, const LinuxCncOptions& options) {
  ECS_DO(check_exportable(source.map));
  ControllerExport made;
  std::vector<Component> carried;
  for (const Axis axis : kAllAxes) {
    const Component component = positioning_curve(axis);
    const auto curve = curve_of(source.map, component);
    if (!curve || !has_axis(source, axis)) continue;
    const std::string name = file_of(axis);
    made.files.push_back({name, rows_text(thinned(*curve, options.most_points), options)});
    const std::string& text = made.files.back().content;
    auto again = parse_linuxcnc(text, name, {axis, options.type, options.units, true});
    if (!again) return unwritable(again.error());
    const ControlCurve written{again->tables[0].position_mm, again->tables[0].compensation,
                               again->tables[1].compensation};
    ECS_DO(append(made.applied, std::move(*again), true));
    made.tables.push_back({std::string(name_of(component)), name, curve->position_mm.size(), written.position_mm.size(),
                           largest_in(written),
                           deviation_from_unit(written, source.map, component, source.parameters.interpolation), 0.0});
    for (std::string& line : linuxcnc_ini_lines(joint_of(source.parameters, axis), name, options.type))
      made.settings.push_back(std::move(line));
    carried.push_back(component);
  }
  if (carried.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning table (EXX, EYY, EZZ) of an axis that the machine has: LinuxCNC "
                   "compensates nothing else");
  leave_behind(made, source, carried, "cannot be corrected by a table per joint, which has no lever arm",
               "a table per joint acts along its own axis only");
  made.notes = {
      "BACKLASH of these joints is ignored by LinuxCNC once they have a COMP_FILE: their reversal error is in the "
      "columns forward and reverse of that file",
      "beyond the ends of a file LinuxCNC uses the end values, as the unit does",
      "joints are numbered as in trivkins; with other kinematics put COMP_FILE into the section of the joint that "
      "moves the axis",
      "LinuxCNC does not report a wrong file: compare the pin joint.N.backlash-filt with the table "
      "(modules/controllers/README.md)"};
  return made;
}

extern const ControllerFormat linuxcnc_format{
    .id = "linuxcnc",
    .title = "LinuxCNC",
    .name = "LinuxCNC",
    .summary = "a screw compensation file for each joint: positioning, both approaches",
    .example = "ecs export linuxcnc map.csv --params mill.toml -o linuxcnc/",
    .output_help = "folder for x.comp, y.comp, z.comp",
    .marks = "rows of three numbers",
    .place = 10,
    .holds = {"yes", "yes, by position", "–", "–", "–", "256 a joint, anywhere"},
    .resolution_um = 0.001,
    .write_options = {{.name = "type",
                       .help = "COMP_FILE_TYPE: 0 positions, 1 trims (the default)",
                       .fallback = "1",
                       .words = {"0", "1"}},
                      {.name = "units",
                       .help = "LINEAR_UNITS of the control; default mm",
                       .fallback = "mm",
                       .words = {"mm", "inch"}},
                      {.name = "points",
                       .help = "maximum number of points of a file; LinuxCNC accepts 256",
                       .fallback = "256",
                       .range = IntegerRange{2, static_cast<int>(kLinuxCncMostPoints)}}},
    .read_options = {{.name = "axis", .help = "axis; default: from the file's name"},
                     {.name = "type", .help = "COMP_FILE_TYPE; default: deduced from the numbers", .words = {"0", "1"}},
                     {.name = "units", .help = "LINEAR_UNITS; default mm", .fallback = "mm", .words = {"mm", "inch"}},
                     {.name = "as-loaded", .help = "read only the rows that LinuxCNC would accept", .is_flag = true}},
    .is_file = is_linuxcnc_file,
    .recognises = begins_with_number,
    .write = write_linuxcnc,
    .read = read_linuxcnc,
};

namespace {

struct Row {
  double nominal = 0.0, forward = 0.0, reverse = 0.0;
  int line = 0;
};

/// Reading one file: rows, and what is to be said about them.
class LinuxCncReader {
 public:
  LinuxCncReader(const std::string& file, bool as_loaded) : file_(file), findings_(file), as_loaded_(as_loaded) {}

  void take(std::string_view line, int number) {
    const auto words = blank_words(line);
    if (words.empty()) return stops(number, 1, "an empty line");
    const auto column = [&](std::size_t word) { return laser::column_of(line, words[word]); };
    if (words[0].front() == '#' || words[0].front() == ';') return stops(number, column(0), "a comment");
    announce_stop();
    if (stopped_ && as_loaded_) return;
    Row row;
    row.line = number;
    double* const columns[] = {&row.nominal, &row.forward, &row.reverse};
    for (std::size_t i = 0; i < 3; ++i) {
      if (i >= words.size())
        return findings_.add(number, static_cast<int>(line.size()) + 1, "expected three numbers, found {}", i);
      const auto value = number_in(words[i]);
      if (!value) return wrong_number(words[i], number, column(i));
      *columns[i] = *value;
    }
    if (words.size() > 3) warn(number, column(3), "LinuxCNC does not read text after the third number");
    keep(row, column(0));
  }

  /// CR alone ends a line here, not in LinuxCNC.
  void look_at_line_ends(std::string_view text) {
    int line = 1;
    for (std::size_t i = 0; i + 1 < text.size(); ++i) {
      if (text[i] == '\r' && text[i + 1] != '\n')
        return warn(line, 0,
                    "the line ends with CR alone: LinuxCNC separates lines at LF only and would treat the next line as "
                    "part of this one; save the file with LF");
      if (text[i] == '\n') ++line;
    }
  }

  void stops(int line, int column, std::string_view at) {
    if (!stopped_) pending_ = {line, column, std::string(at)};
    stopped_ = true;
  }

  /// After the last line.
  void finish() {
    if (rows_.empty()) findings_.add(0, 0, "no rows: expected three numbers a line, as in \"50.0 0.004 0.007\"");
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] laser::Findings& findings() { return findings_; }
  [[nodiscard]] std::vector<Problem> warnings() { return std::move(warnings_); }

 private:
  struct Stop {
    int line = 0, column = 0;
    std::string at;
  };

  void warn(int line, int column, std::string message) {
    constexpr std::size_t kMost = 20;
    if (warnings_.size() < kMost)
      warnings_.push_back({ProblemKind::bad_input, std::move(message), file_, line, column, {}});
  }

  void wrong_number(std::string_view word, int line, int column) {
    const bool comma = word.find(',') != word.npos;
    findings_.add(line, column, "expected a number, found {}{}; LinuxCNC would stop here without a message",
                  laser::in_quotes(word), comma ? " (use a decimal point, and blanks between numbers)" : "");
  }

  /// A row below a stop that LinuxCNC makes in silence: said once, when it costs something.
  void announce_stop() {
    if (pending_.at.empty()) return;
    warn(pending_.line, pending_.column,
         fmt::format("LinuxCNC stops reading at {} without a message: it uses nothing below this line", pending_.at));
    pending_.at.clear();
  }

  void keep(const Row& row, int column) {
    if (!rows_.empty() && row.nominal <= rows_.back().nominal)
      return warn(
          row.line, column,
          fmt::format(
              "nominal {} does not increase (line {} has {}): LinuxCNC ignores this row, and it is ignored here too",
              row.nominal, rows_.back().line, rows_.back().nominal));
    if (rows_.size() == kLinuxCncMostPoints) {
      if (!full_) warn(row.line, column, "LinuxCNC accepts 256 points: it uses none from this line on");
      full_ = true;
    }
    if (full_ && as_loaded_) return;
    rows_.push_back(row);
  }

  std::string file_;
  laser::Findings findings_;
  bool as_loaded_ = false;
  bool stopped_ = false;
  bool full_ = false;
  Stop pending_;
  std::vector<Row> rows_;
  std::vector<Problem> warnings_;
};

/// Type 0 holds positions, type 1 small differences: told apart where one of the two is out of the question.
std::optional<int> type_by_numbers(const std::vector<Row>& rows) {
  double as_trim = 0.0, as_position = 0.0;
  for (const Row& row : rows)
    for (const double value : {row.forward, row.reverse}) {
      as_trim = std::max(as_trim, std::abs(value));
      as_position = std::max(as_position, std::abs(row.nominal - value));
    }
  constexpr double kClearly = 10.0;
  if (as_position * kClearly < as_trim) return 0;
  if (as_trim * kClearly < as_position) return 1;
  return std::nullopt;
}

}  // namespace

Result<ControllerTables> parse_linuxcnc(std::string_view text, const std::string& file_name,
                                        const LinuxCncReadOptions& options) {
  LinuxCncReader reader(file_name, options.as_loaded);
  const std::string source_text(text);
  if (text.starts_with("\xEF\xBB\xBF")) {
    text.remove_prefix(3);
    reader.stops(1, 1, "the byte order mark");
  }
  reader.look_at_line_ends(text);
  for (const NumberedLine& line : numbered_lines_of(text)) reader.take(line.text, line.number);
  if (reader.findings().empty()) reader.finish();
  if (!reader.findings().empty()) return tl::unexpected(reader.findings().as_problem());

  ControllerTables read;
  const auto type = options.type ? options.type : type_by_numbers(reader.rows());
  if (!type)
    return problem_at(file_name, 0, 0,
                      "the numbers may be positions (COMP_FILE_TYPE 0) or trims (1): give --type as in the INI file");
  if (!options.type)
    read.notes.push_back(fmt::format("{}: read as COMP_FILE_TYPE {}, deduced from its numbers", file_name, *type));
  const double to_mm = options.units == MachineUnits::inch ? kMmPerInch : 1.0;
  const Component component = positioning_curve(options.axis);
  laser::MapTable forward{component, Approach::forward, {}, {}}, reverse{component, Approach::reverse, {}, {}};
  for (const Row& row : reader.rows()) {
    if (std::abs(row.nominal * to_mm) > kLargestPosition_mm)
      reader.findings().add(row.line, 1, "{} is not a plausible position", row.nominal);
    const auto trim_um = [&](double value) { return (*type == 0 ? row.nominal - value : value) * to_mm * kUmPerMm; };
    for (const double value : {row.forward, row.reverse})
      if (std::abs(trim_um(value)) > kLargestValue_um)
        reader.findings().add(
            row.line, 1, "a compensation of {:.6g} mm is implausibly large. Is the file of type {}, in these units?",
            trim_um(value) / kUmPerMm, *type);
    forward.position_mm.push_back(row.nominal * to_mm);
    forward.compensation.push_back(trim_um(row.forward));
    reverse.compensation.push_back(trim_um(row.reverse));
  }
  if (!reader.findings().empty()) return tl::unexpected(reader.findings().as_problem());
  reverse.position_mm = forward.position_mm;
  read.tables = {std::move(forward), std::move(reverse)};
  read.warnings = reader.warnings();
  read.sources.push_back({std::string(name_of(component)), file_name, sha256_hex(source_text)});
  return read;
}

}  // namespace ecs::controllers
