// TwinCAT CNC and ISG kernels, writing.
#include "controllers/twincat.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "controllers/curve.hpp"
#include "controllers/format.hpp"
#include "controllers/twincat_list.hpp"

namespace ecs::controllers {
namespace {

constexpr double kMostOfTwinCat2_um = 3276.7;  // 16 bit of tenths

std::string file_of(int axis_number) { return fmt::format("achskw{}.lis", axis_number); }

/// What stands in a list is this times the compensation.
double sign_of(const TwinCatOptions& options) { return options.adds.value_or(false) ? 1.0 : -1.0; }

/// The list travels alone: what is not certain stands in it.
std::string_view sign_warning(bool adds) {
  return adds ? "sign against the manual's example, tried on no control: check one axis with the laser before use "
                "(--ssfk-sign subtracts turns it)"
              : "sign after the manual's example, tried on no control: check one axis with the laser before use "
                "(--ssfk-sign adds turns it)";
}

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
  const double sign = sign_of(options);
  const bool adds = options.adds.value_or(false);
  const auto tenths = [](double value, double per_unit) { return std::llround(value * per_unit); };
  std::string text = fmt::format(
      "# {} error of {}, {}\n# {}\n"
      "kopf.achs_nr {}\nkopf.log_achs_name {}\nkw.ssfk.unit 1\nkw.ssfk.interval 0\nkw.ssfk.kw_startpos {}\n"
      "kw.ssfk.kw_nr_max {}\nkw.ssfk.bilateral 1\nkw.ssfk.modulo 0\n",
      name_of(curve_of(static_cast<Sense>(axis), axis)), letter_of(axis), list_sign(adds), sign_warning(adds), number,
      letter_of(axis), tenths(curve.position_mm.front(), kTenthsPerMm), curve.position_mm.size());
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    text += fmt::format("kw.ssfk.table[{0}].setpoint {1}\nkw.ssfk.table[{0}].pos {2}\nkw.ssfk.table[{0}].neg {3}\n", i,
                        tenths(curve.position_mm[i], kTenthsPerMm), tenths(sign * curve.forward[i], kTenthsPerUm),
                        tenths(sign * curve.reverse[i], kTenthsPerUm));
  return text;
}

/// The list is switched on and off where the axis stands; at the reference position as a rule.
void note_step(const ControlCurve& kept, Axis axis, double reference_mm, double sign, ControllerExport& made) {
  const auto held = [&](Approach approach) {
    return std::round(sign * value_at(kept, approach, reference_mm) * kTenthsPerUm) / kTenthsPerUm + 0.0;
  };
  const double pos_um = held(Approach::forward), neg_um = held(Approach::reverse);
  if (pos_um == 0.0 && neg_um == 0.0) return;
  made.notes.push_back(
      fmt::format("at the reference position of {} ({} mm) the list holds {}: the axis steps by it when the "
                  "compensation becomes active",
                  letter_of(axis), reference_mm + 0.0,
                  pos_um == neg_um ? fmt::format("{:.1f} um", pos_um)
                                   : fmt::format("{:.1f} um in pos, {:.1f} um in neg", pos_um, neg_um)));
}

void note_what_is_too_large(const std::string& name, double largest_um, ControllerExport& made) {
  if (largest_um <= kMostOfTwinCat2_um) return;
  made.notes.push_back(fmt::format("{} holds values up to {:.1f} um: beyond {} um they do not fit TwinCAT 2 (16 bit)",
                                   name, largest_um, kMostOfTwinCat2_um));
}

/// One axis into files, tables, notes and `applied`; false: the map or the machine has none.
Result<bool> add_axis(const ExportSource& source, const TwinCatOptions& options, Axis axis, ControllerExport& made) {
  const Component component = curve_of(static_cast<Sense>(axis), axis);
  const auto curve = curve_of(source.map, component);
  if (!curve || !source.parameters.axis_present[index_of(axis)]) return false;
  const ControlCurve kept = in_tenths(thinned(*curve, options.most_points));
  const std::string name = file_of(options.axis_number[index_of(axis)]);
  made.files.push_back({name, list_text(kept, axis, options)});
  auto again = parse_twincat(made.files.back().content, name, options);
  if (!again) return unwritable(again.error());
  ECS_DO(append(made.applied, std::move(*again), true));
  made.tables.push_back({std::string(name_of(component)), name, curve->position_mm.size(), kept.position_mm.size(),
                         largest_in(kept),
                         deviation_from_unit(kept, source.map, component, source.parameters.interpolation), 0.0});
  note_step(kept, axis, source.parameters.axes[index_of(axis)].datum.reference_position_mm, sign_of(options), made);
  note_what_is_too_large(name, largest_in(kept), made);
  return true;
}

void add_settings(const TwinCatOptions& options, const std::vector<Component>& carried, ControllerExport& made) {
  made.settings.push_back(fmt::format("start-up list: zahl_kw {}", carried.size()));
  for (std::size_t i = 0; i < carried.size(); ++i) {
    const int number = options.axis_number[index_of(moving_axis(carried[i]))];
    made.settings.push_back(
        fmt::format("start-up list: achs_kw_log_ax_nr[{0}] {1}, achs_kw[{0}] {2}", i, number, file_of(number)));
    made.settings.push_back(fmt::format("list of axis {}: lr_param.ssfk 1", number));
  }
}

constexpr long long kMostAxes = 65'534;  ///< logical axis numbers of the control

Result<TwinCatOptions> options_in(const OptionValues& values) {
  TwinCatOptions options;
  const std::string_view axes = values.text("axes"), sign = values.text("ssfk-sign");
  if (!sign.empty()) options.adds = sign == "adds";
  for (const auto& [axis, name] : axis_pairs(axes)) {
    const auto number = integer_in(name);
    if (!axis || !number || *number < 1 || *number > kMostAxes)
      return problem(ProblemKind::usage,
                     fmt::format("--axes: expected X=NUMBER,Y=NUMBER,Z=NUMBER, as in X=1, found \"{}\"", axes));
    options.axis_number[index_of(*axis)] = static_cast<int>(*number);
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && options.axis_number[index_of(a)] == options.axis_number[index_of(b)])
        return problem(ProblemKind::usage, fmt::format("--axes: {} and {} have the same number {}", letter_of(a),
                                                       letter_of(b), options.axis_number[index_of(a)]));
  return options;
}

Result<ControllerExport> write_twincat(const ExportSource& source, const OptionValues& values) {
  ECS_TRY(options, options_in(values));
  options.most_points = static_cast<std::size_t>(values.integer("points"));
  return twincat_export(source, options);
}

Result<ControllerTables> read_twincat(const ReadRequest& request) {
  ECS_TRY(options, options_in(request.options));
  ECS_TRY(axis, axis_option(request));
  return parse_twincat(request.text, request.file_name, options, axis);
}

const FormatOption kSign{.name = "ssfk-sign",
                         .help =
                             "what TwinCAT does with a value; default subtracts, as its manual computes; lists of "
                             "ours say it",
                         .words = {"subtracts", "adds"}};

}  // namespace

Result<ControllerExport> twincat_export(const ExportSource& source, const TwinCatOptions& options) {
  ECS_DO(check_exportable(source.map));
  ControllerExport made;
  std::vector<Component> carried;
  for (const Axis axis : kAllAxes) {
    ECS_TRY(added, add_axis(source, options, axis, made));
    if (added) carried.push_back(curve_of(static_cast<Sense>(axis), axis));
  }
  if (carried.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning table (EXX, EYY, EZZ) of an axis that the machine has: leadscrew "
                   "compensation holds nothing else");
  add_settings(options, carried, made);
  leave_behind(made, source, carried, "a table of one axis has no lever arm",
               "leadscrew compensation acts along its own axis only");
  made.notes.insert(
      made.notes.begin(),
      {"no further backlash compensation for these axes (P-AXIS-00021 lr_param.anwahl_losekomp 0): the reversal is in "
       "the two tables",
       "beyond the ends of a list the control holds the end values, as the unit does",
       "values are whole tenths of a micrometre",
       fmt::format("the sign is {} the manual's worked example; no such control was at hand: measure one axis again "
                   "first (docs/controllers.md)",
                   options.adds.value_or(false) ? "against" : "that of")});
  return made;
}

bool is_twincat_file(std::string_view name) {
  const auto number = name.starts_with("achskw") && name.ends_with(".lis") && name.size() > 10
                          ? integer_in(name.substr(6, name.size() - 10))
                          : std::nullopt;
  return number && *number > 0 && *number <= kMostAxes && name == file_of(static_cast<int>(*number));
}

extern const ControllerFormat kTwinCat{
    .id = "twincat",
    .title = "TwinCAT CNC, leadscrew compensation",
    .name = "TwinCAT",
    .summary = "TwinCAT CNC and ISG kernels: a leadscrew compensation list for each axis, both directions",
    .example = "ecs export twincat map.csv --params mill.toml -o twincat/",
    .output_help = "folder for achskw1.lis, achskw2.lis, achskw3.lis",
    .marks = "kw.ssfk",
    .holds = {"yes", "yes, by position", "–", "–", "–", "1,499 an axis, anywhere"},
    .resolution_um = 0.1,
    .tables_add_up = false,
    .write_options = {kSign,
                      {.name = "axes", .help = "logical axis numbers of the control; default X=1,Y=2,Z=3"},
                      {.name = "points",
                       .help = "most points of a list; default 1499",
                       .fallback = "1499",
                       .range = IntegerRange{2, static_cast<int>(kTwinCatMostPoints)}}},
    .read_options = {{.name = "axis", .help = "the axis; default as the list says"},
                     {.name = "axes", .help = "logical axis numbers; default X=1,Y=2,Z=3"},
                     kSign},
    .is_file = is_twincat_file,
    .recognises = [](std::string_view text) { return lower(text).find("kw.ssfk.") != std::string::npos; },
    .write = write_twincat,
    .read = read_twincat,
};

}  // namespace ecs::controllers
