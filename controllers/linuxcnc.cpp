// LinuxCNC, writing.
#include "controllers/linuxcnc.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "controllers/curve.hpp"
#include "controllers/format.hpp"

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

std::string file_of(Axis axis) { return fmt::format("{}.comp", static_cast<char>(letter_of(axis) - 'X' + 'x')); }

MachineUnits units_option(const OptionValues& options) {
  return options.text("units") == "inch" ? MachineUnits::inch : MachineUnits::mm;
}

/// The first line with content begins with a number.
bool begins_with_number(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == ';') continue;
    return number_in(content.substr(0, content.find_first_of(" \t"))).has_value();
  }
  return false;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// "x.comp", "mill_y.comp", "screwcompZ.dat": a letter of its own at the end of the name.
std::optional<Axis> axis_in_name(const std::string& file) {
  const std::string stem = std::filesystem::path(file).stem().string();
  if (stem.empty()) return std::nullopt;
  const char last = stem.back();
  const bool capital = last >= 'A' && last <= 'Z';
  const bool apart = stem.size() == 1 || !is_letter(stem[stem.size() - 2]) ||
                     (capital && stem[stem.size() - 2] >= 'a' && stem[stem.size() - 2] <= 'z');
  return apart ? axis_of(capital ? last : static_cast<char>(last - 'a' + 'A')) : std::nullopt;
}

Result<ControllerExport> write_linuxcnc(const ExportSource& source, const OptionValues& options) {
  return linuxcnc_export(
      source, {options.integer("type"), units_option(options), static_cast<std::size_t>(options.integer("points"))});
}

Result<ControllerTables> read_linuxcnc(const ReadRequest& request) {
  ECS_TRY(given, axis_option(request));
  const auto axis = given ? given : axis_in_name(request.file_name);
  if (!axis)
    return problem(ProblemKind::usage,
                   fmt::format("{}: the name does not end in x, y or z: give --axis", request.file_name));
  LinuxCncReadOptions options{*axis, std::nullopt, units_option(request.options), request.options.flag("as-loaded")};
  if (!request.options.text("type").empty()) options.type = request.options.integer("type");
  return parse_linuxcnc(request.bytes, request.file_name, options);
}

}  // namespace

std::vector<std::string> linuxcnc_ini_lines(int joint, const std::string& file_name, int type) {
  return {fmt::format("[JOINT_{}]", joint), fmt::format("COMP_FILE = {}", file_name),
          fmt::format("COMP_FILE_TYPE = {}", type)};
}

Result<ControllerExport> linuxcnc_export(const ExportSource& source, const LinuxCncOptions& options) {
  ECS_DO(check_exportable(source.map));
  ControllerExport made;
  std::vector<Component> carried;
  for (const Axis axis : kAllAxes) {
    const Component component = curve_of(static_cast<Sense>(axis), axis);
    const auto curve = curve_of(source.map, component);
    if (!curve || !source.parameters.axis_present[index_of(axis)]) continue;
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
  leave_behind(made, source, carried, "a joint's table has no lever arm",
               "a joint's table acts along its own axis only");
  made.notes = {
      "BACKLASH of these joints is ignored by LinuxCNC once they have a COMP_FILE: the reversal is in the "
      "two columns",
      "beyond the ends of a file LinuxCNC holds the end values, as the unit does",
      "joints are numbered as trivkins does it; with other kinematics put the lines under the joint that "
      "moves the axis",
      "a wrong file is not reported: read joint.N.backlash-filt back (docs/controllers.md)"};
  return made;
}

bool is_linuxcnc_file(std::string_view name) {
  return std::any_of(kAllAxes.begin(), kAllAxes.end(), [&](Axis axis) { return name == file_of(axis); });
}

extern const ControllerFormat kLinuxCnc{
    .id = "linuxcnc",
    .title = "LinuxCNC",
    .name = "LinuxCNC",
    .summary = "a screw compensation file for each joint: positioning, both approaches",
    .example = "ecs export linuxcnc map.csv --params mill.toml -o linuxcnc/",
    .output_help = "folder for x.comp, y.comp, z.comp",
    .marks = "rows of three numbers",
    .holds = {"yes", "yes, by position", "–", "–", "–", "256 a joint, anywhere"},
    .resolution_um = 0.001,
    .tables_add_up = false,
    .write_options = {{.name = "type",
                       .help = "COMP_FILE_TYPE: 0 positions, 1 trims (the default)",
                       .fallback = "1",
                       .words = {"0", "1"}},
                      {.name = "units",
                       .help = "LINEAR_UNITS of the control; default mm",
                       .fallback = "mm",
                       .words = {"mm", "inch"}},
                      {.name = "points",
                       .help = "most points of a file; LinuxCNC takes 256",
                       .fallback = "256",
                       .range = IntegerRange{2, static_cast<int>(kLinuxCncMostPoints)}}},
    .read_options = {{.name = "axis", .help = "the axis; default from the file's name"},
                     {.name = "type", .help = "COMP_FILE_TYPE; default by the numbers", .words = {"0", "1"}},
                     {.name = "units", .help = "LINEAR_UNITS; default mm", .fallback = "mm", .words = {"mm", "inch"}},
                     {.name = "as-loaded", .help = "only the rows that it would take itself", .is_flag = true}},
    .is_file = is_linuxcnc_file,
    .recognises = begins_with_number,
    .write = write_linuxcnc,
    .read = read_linuxcnc,
};

}  // namespace ecs::controllers
