// LinuxCNC, writing. Does not live here: reading (linuxcnc_reader.cpp).
#include "controllers/linuxcnc.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "controllers/curve.hpp"

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

}  // namespace

std::vector<std::string> linuxcnc_ini_lines(int joint, const std::string& file_name, int type) {
  return {fmt::format("[JOINT_{}]", joint), fmt::format("COMP_FILE = {}", file_name),
          fmt::format("COMP_FILE_TYPE = {}", type)};
}

Result<ControllerExport> linuxcnc_export(const ExportSource& source, const LinuxCncOptions& options) {
  if (const auto sound = check_exportable(source.map); !sound) return tl::unexpected(sound.error());
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
    if (auto done = append(made.applied, std::move(*again), true); !done) return tl::unexpected(done.error());
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

}  // namespace ecs::controllers
