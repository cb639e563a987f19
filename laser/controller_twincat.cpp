// TwinCAT CNC and ISG kernels, writing. Does not live here: reading (controller_twincat_reader.cpp).
#include "laser/controller_twincat.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "laser/controller_curve.hpp"

namespace ecs::laser {
namespace {

constexpr double kTenthsPerUm = 10.0;
constexpr double kTenthsPerMm = 10'000.0;

/// The curve in whole tenths of a micrometre, positions and values; of points that fall together the first.
ControlCurve in_tenths(const ControlCurve& curve) {
  const auto rounded = [](double value, double tenths) { return std::round(value * tenths) / tenths; };
  ControlCurve out;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
    const double place = rounded(curve.position_mm[i], kTenthsPerMm);
    if (!out.position_mm.empty() && place <= out.position_mm.back()) continue;
    out.position_mm.push_back(place);
    out.forward.push_back(rounded(curve.forward[i], kTenthsPerUm));
    out.reverse.push_back(rounded(curve.reverse[i], kTenthsPerUm));
  }
  return out;
}

std::string list_text(const ControlCurve& curve, Axis axis, const TwinCatOptions& options) {
  const int number = options.axis_number[index_of(axis)];
  const double sign = options.adds ? 1.0 : -1.0;
  const auto tenths = [](double value, double per_unit) { return std::llround(value * per_unit); };
  std::string text = fmt::format(
      "# {} error of {}, {}, in 0.1 um; pos and neg: direction of motion\n"
      "kopf.achs_nr {}\nkopf.log_achs_name {}\nkw.ssfk.unit 1\nkw.ssfk.interval 0\nkw.ssfk.kw_startpos {}\n"
      "kw.ssfk.kw_nr_max {}\nkw.ssfk.bilateral 1\nkw.ssfk.modulo 0\n",
      name_of(curve_of(static_cast<Sense>(axis), axis)), letter_of(axis),
      options.adds ? "nominal minus actual" : "actual minus nominal", number, letter_of(axis),
      tenths(curve.position_mm.front(), kTenthsPerMm), curve.position_mm.size());
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    text += fmt::format("kw.ssfk.table[{0}].setpoint {1}\nkw.ssfk.table[{0}].pos {2}\nkw.ssfk.table[{0}].neg {3}\n", i,
                        tenths(curve.position_mm[i], kTenthsPerMm), tenths(sign * curve.forward[i], kTenthsPerUm),
                        tenths(sign * curve.reverse[i], kTenthsPerUm));
  return text;
}

double largest_in(const ControlCurve& curve) {
  double largest = 0.0;
  for (const auto* side : {&curve.forward, &curve.reverse})
    for (const double value : *side) largest = std::max(largest, std::abs(value));
  return largest;
}

/// One axis into files, tables and `applied`; false: the map or the machine has none.
Result<bool> add_axis(const ExportSource& source, const TwinCatOptions& options, Axis axis, ControllerExport& made) {
  const Component component = curve_of(static_cast<Sense>(axis), axis);
  const auto curve = curve_of(source.map, component);
  if (!curve || !source.parameters.axis_present[index_of(axis)]) return false;
  const ControlCurve kept = in_tenths(thinned(*curve, options.most_points));
  const int number = options.axis_number[index_of(axis)];
  const std::string name = fmt::format("achskw{}.lis", number);
  made.files.push_back({name, list_text(kept, axis, options)});
  auto again = parse_twincat(made.files.back().content, name, options);
  if (!again) return tl::unexpected(again.error());
  if (auto done = append(made.applied, std::move(*again), true); !done) return tl::unexpected(done.error());
  made.tables.push_back({std::string(name_of(component)), name, curve->position_mm.size(), kept.position_mm.size(),
                         largest_in(kept),
                         deviation_from_unit(kept, source.map, component, source.parameters.interpolation), 0.0});
  return true;
}

void add_settings(const TwinCatOptions& options, const std::vector<Component>& carried, ControllerExport& made) {
  made.settings.push_back(fmt::format("start-up list: zahl_kw {}", carried.size()));
  for (std::size_t i = 0; i < carried.size(); ++i) {
    const int number = options.axis_number[index_of(moving_axis(carried[i]))];
    made.settings.push_back(
        fmt::format("start-up list: achs_kw_log_ax_nr[{0}] {1}, achs_kw[{0}] achskw{1}.lis", i, number));
    made.settings.push_back(fmt::format("list of axis {}: lr_param.ssfk 1", number));
  }
}

}  // namespace

Result<ControllerExport> twincat_export(const ExportSource& source, const TwinCatOptions& options) {
  if (const auto sound = check_exportable(source.map); !sound) return tl::unexpected(sound.error());
  ControllerExport made;
  std::vector<Component> carried;
  for (const Axis axis : kAllAxes) {
    const auto added = add_axis(source, options, axis, made);
    if (!added) return tl::unexpected(added.error());
    if (*added) carried.push_back(curve_of(static_cast<Sense>(axis), axis));
  }
  if (carried.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning table (EXX, EYY, EZZ) of an axis that the machine has: leadscrew "
                   "compensation holds nothing else");
  add_settings(options, carried, made);
  leave_behind(made, source, carried, "a table of one axis has no lever arm",
               "leadscrew compensation acts along its own axis only");
  made.notes = {
      "no further backlash compensation (P-AXIS-00103) for these axes: the reversal is in the two tables",
      "beyond the ends of a list the control holds the end values, as the unit does",
      "values are whole tenths of a micrometre",
      "the sign is that of the manual's worked example; no such control was at hand: measure one axis again first "
      "(docs/controllers.md)"};
  return made;
}

}  // namespace ecs::laser
