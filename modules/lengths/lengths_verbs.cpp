// `ecs lengths fit`: files read, the 21 components identified from lengths, the map made. `plan`: which lengths to
// measure for a wanted uncertainty of the volume, in the fewest minutes. `compare`: a map against lengths that had no
// part in it. All answers as text and JSON.
// Does not live here: the least squares and the choice (identify.hpp, plan_lengths.hpp).

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/cli/action.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/json_fwd.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/error_map.hpp"
#include "laser/measurement_set.hpp"
#include "modules/lengths/compare_lengths.hpp"
#include "modules/lengths/identify.hpp"
#include "modules/lengths/plan_lengths.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

/// As typed; empty: not given.
struct LengthsArguments {
  std::string file, machine;
  std::string params;              ///< needed for a map
  std::string output, params_out;  ///< files to write
  std::string knots;               ///< "100,50,50" [mm]
  std::vector<std::string> zero;   ///< EBY="reason"
  model::IdentifySettings settings;
  std::string customer, engineer, date;
  static cli::Fields<LengthsArguments> fields();
};

struct LengthsWork {
  model::LengthTest test;
  std::string machine_name;
  model::Identification found;
  std::vector<laser::DeclaredZero> zero;
  std::optional<laser::ErrorMap> map;          ///< where parameters are given and everything is determined
  std::optional<params::ParametersFile> unit;  ///< with the squareness that was found
};

/// As typed; empty: not given.
struct LengthsPlanAsked {
  std::string machine;
  double volume_um = 0.0;  ///< wanted expanded uncertainty
  std::string instrument = "tracker";
  std::string tools = "0,0,0;0,0,-250;150,0,-120";
  std::string stations, knots;
  double set_up_minutes = model::MeasuringTimes{}.line_minutes;
  model::LengthPlanSettings settings;
  std::string output;  ///< file to write
  static cli::Fields<LengthsPlanAsked> fields();
};

/// @param stopped  asked now and then: true ends the search, and the problem says so
[[nodiscard]] Result<model::LengthPlan> lengths_plan(const LengthsPlanAsked& asked,
                                                     const std::function<bool()>& stopped = {});

/// As typed; empty: not given.
struct LengthsCompared {
  std::string map, file, params;
  double at_least_percent = 0.0;  ///< of the errors explained; less does not hold
  static cli::Fields<LengthsCompared> fields();
};

/// Signs of the printed equations of the thesis: rotations about X and Z, and squareness but B0Z, are turned
/// (docs/physics.md).
double sign_of(Component c, Convention convention) {
  if (convention == Convention::iso) return 1.0;
  const bool turned = is_squareness(c) ? c != Component::B0Z : sense_of(c) == Sense::EA || sense_of(c) == Sense::EC;
  return turned ? -1.0 : 1.0;
}

Result<void> measured_there(const model::LengthTest& test, const params::Machine& machine, const std::string& file) {
  const auto other = laser::other_machine({test.machine, ""}, {machine.name, ""}, "the machine file is of");
  if (!other) return {};
  return tl::unexpected(Problem{ProblemKind::refused, *other, file, 0, 0, {}});
}

Result<void> same_machine(const params::ParametersFile& unit, const params::Machine& machine, const std::string& file) {
  const UnitParameters& parameters = unit.parameters;
  const auto refuse = [&](std::string message) { return problem_at(file, 0, 0, std::move(message)); };
  if (!unit.identity.machine.empty() && !machine.name.empty() && unit.identity.machine != machine.name)
    return refuse(fmt::format("expected the parameters of the machine \"{}\", found those of \"{}\"", machine.name,
                              unit.identity.machine));
  if (configuration_of(parameters) != machine.configuration)
    return refuse(fmt::format("expected the parameters of a machine {}, found {}", machine.configuration,
                              configuration_of(parameters)));
  const MeasurementLines lines = params::measurement_lines_of(machine);
  for (const Axis axis : kAllAxes)
    for (const Axis other : kAllAxes) {
      const double expected = lines[index_of(axis)][index_of(other)];
      const double found = parameters.measurement_lines_mm[index_of(axis)][index_of(other)];
      if (axis != other && expected != found)
        return refuse(fmt::format("axis.{}.measurement_line_mm: expected {} {:g} as in the machine file, found {:g}",
                                  letter_of(axis), letter_of(other), expected, found));
    }
  return {};
}

/// A header counts whole ones.
int freedom_in_map(double freedom) { return std::max(1, static_cast<int>(freedom)); }

laser::ErrorMap map_of(const LengthsWork& work, const LengthsArguments& arguments, const std::string& sha256,
                       const params::Machine& machine) {
  laser::ErrorMap map;
  laser::MapHeader& header = map.header;
  header.customer = arguments.customer;
  header.engineer = arguments.engineer;
  header.date = arguments.date;
  header.machine = work.unit->identity.machine.empty() ? machine.name : work.unit->identity.machine;
  header.serial_number = work.unit->identity.serial_number;
  header.configuration = machine.configuration;
  header.declared_zero = work.zero;
  const std::string file = std::filesystem::path(arguments.file).filename().string();
  const Convention convention = work.unit->parameters.convention;
  for (const model::IdentifiedCurve& curve : work.found.curves) {
    if (!curve.determined) continue;
    const double compensation = -sign_of(curve.component, convention);
    for (const bool forward : {true, false}) {
      laser::MapTable table{curve.component, forward ? Approach::forward : Approach::reverse, curve.position_mm, {}};
      for (const double value : forward ? curve.forward : curve.reverse)
        table.compensation.push_back(compensation * value);
      map.tables.push_back(std::move(table));
    }
    header.sources.push_back({std::string(name_of(curve.component)), file, sha256});
    header.uncertainty.push_back({curve.component, curve.value, curve.pass, freedom_in_map(curve.degrees_of_freedom)});
  }
  for (const model::IdentifiedSquareness& square : work.found.squareness) {
    if (!square.determined) continue;
    header.sources.push_back({std::string(name_of(square.component)), file, sha256});
    header.uncertainty.push_back({square.component, square.u_um_per_m, 0.0, freedom_in_map(square.degrees_of_freedom)});
  }
  header.processing.push_back(fmt::format(
      "identified from {} {} of {} set-ups: {} unknowns, knots {:.0f}, {:.0f}, {:.0f} mm, reversal of degree {}, {} "
      "readings excluded, residual {:.3f} um",
      work.found.readings, model::has_points(work.test) ? "deviations of points" : "lengths", work.test.set_ups.size(),
      work.found.unknowns, work.found.knots_mm[0], work.found.knots_mm[1], work.found.knots_mm[2],
      arguments.settings.reversal_degree, work.found.outliers.size(), work.found.residual_um));
  header.processing.insert(header.processing.end(), work.found.contradictions.begin(), work.found.contradictions.end());
  return map;
}

cli::Fields<LengthsArguments> LengthsArguments::fields() {
  using A = LengthsArguments;
  using S = model::IdentifySettings;
  using cli::Is, cli::Need, cli::Range;
  return {{"LENGTHS", &A::file, "measured lengths, or deviations of points (.csv, modules/lengths/README.md)",
           Need::required},
          {"--machine", &A::machine, "machine file: kinematic chain, travels, datum", Need::required},
          {"--params", &A::params, "parameters of the unit to be compensated"},
          {"-o,--output", &A::output, "map CSV to write; needs --params", Is::output},
          {"--params-out", &A::params_out, "parameter file to write, with the identified squareness", Is::output},
          {"--knots", &A::knots,
           "distance between the knots (points) of the error curves of X,Y,Z [mm]; default: as in the file, else twice "
           "the spacing of its coordinates"},
          {&A::settings,
           cli::Fields<S>{
               {"--reversal-degree", &S::reversal_degree,
                "degree of the polynomial that describes the reversal error along an axis; -1: no reversal error",
                Range{-1, 6}},
               {"--scale", &S::scale_um_per_m,
                "standard uncertainty of the scale of each set-up (air, wavelength) [um/m]; 0: none", Range{0.0}}}},
          {"--zero", &A::zero, "declare a component zero: EBY=\"too small to measure\""},
          {&A::settings, cli::Fields<S>{{"--keep-outliers", &S::keep_outliers, "exclude no readings"}}},
          {"--customer", &A::customer, "customer to state in the map header"},
          {"--engineer", &A::engineer, "engineer to state in the map header"},
          {"--date", &A::date, "date in the map header, as in 2026-03-12"}};
}

/// "100,50,50" as three lengths above 0. @param option  as problems name it
Result<PerAxis<std::optional<double>>> three_lengths_in(const std::string& text, std::string_view option) {
  PerAxis<std::optional<double>> out{};
  if (text.empty()) return out;
  const auto words = split(text, ',');
  for (std::size_t a = 0; a < kAxes && words.size() == kAxes; ++a) {
    out[a] = number_in(trimmed(words[a]));
    if (!out[a] || !(*out[a] > 0.0)) break;
    if (a + 1 == kAxes) return out;
  }
  return problem(ProblemKind::usage, "{}: expected three lengths X,Y,Z above 0 in mm, such as 100,50,50, got \"{}\"",
                 option, text);
}

Result<LengthsWork> lengths_work(const LengthsArguments& arguments) {
  ECS_TRY(knots, three_lengths_in(arguments.knots, "--knots"));
  model::IdentifySettings settings = arguments.settings;
  settings.knots_mm = knots;
  LengthsWork work;
  for (const std::string& word : arguments.zero) {
    ECS_TRY(zero, declared_zero_in(word));
    settings.zero[index_of(zero.component)] = true;
    work.zero.push_back(zero);
  }
  ECS_TRY(text, read_file_of(FileKind::lengths, arguments.file));
  ECS_TRY(test, model::parse_lengths(text, arguments.file));
  ECS_TRY(machine, params::read_machine(arguments.machine));
  ECS_DO(measured_there(test, machine.machine, arguments.file));
  work.machine_name = machine.machine.name;
  if (!arguments.params.empty()) {
    ECS_TRY(unit, params::read_whole_parameters(arguments.params));
    ECS_DO(same_machine(unit, machine.machine, arguments.params));
    work.unit = std::move(unit);
  }
  ECS_TRY(found, model::identify(test, machine.machine, settings));
  work.test = std::move(test);
  work.found = std::move(found);
  if (!work.unit || !work.found.whole()) return work;
  for (const model::IdentifiedSquareness& square : work.found.squareness)
    if (square.determined)
      squareness_um_per_m(work.unit->parameters, square.component) =
          sign_of(square.component, work.unit->parameters.convention) * square.um_per_m;
  work.map = map_of(work, arguments, sha256_hex(text), machine.machine);
  return work;
}

/// "0,0,0;0,0,-250"
Result<std::vector<Vector3>> places_in(const std::string& text, std::string_view option) {
  std::vector<Vector3> out;
  if (text.empty()) return out;
  for (const std::string_view part : split(text, ';')) {
    const auto words = split(part, ',');
    Vector3 place{};
    bool right = words.size() == kAxes;
    for (std::size_t a = 0; a < kAxes && right; ++a) {
      const auto number = number_in(trimmed(words[a]));
      right = number.has_value();
      place[a] = number.value_or(0.0);
    }
    if (!right)
      return problem(ProblemKind::usage, "{}: expected X,Y,Z;X,Y,Z in mm, such as 0,0,0;0,0,-250, got \"{}\"", option,
                     text);
    out.push_back(place);
  }
  return out;
}

Result<model::LengthPlanSettings> settings_of(const LengthsPlanAsked& a) {
  model::LengthPlanSettings s = a.settings;
  s.volume_U_um = a.volume_um;
  s.instrument = a.instrument == "tracker"          ? model::LengthInstrument::tracker
                 : a.instrument == "interferometer" ? model::LengthInstrument::interferometer
                                                    : model::LengthInstrument::ball_bar;
  ECS_TRY(knots, three_lengths_in(a.knots, "--knots"));
  s.knots_mm = knots;
  ECS_TRY(tools, places_in(a.tools, "--tools"));
  if (!tools.empty()) s.tools_mm = tools;
  ECS_TRY(stations, places_in(a.stations, "--stations"));
  s.stations_mm = stations;
  s.times.line_minutes = s.times.align_minutes = a.set_up_minutes;
  return s;
}

cli::Fields<LengthsPlanAsked> LengthsPlanAsked::fields() {
  using A = LengthsPlanAsked;
  using S = model::LengthPlanSettings;
  using cli::Is, cli::Need, cli::Range, cli::Words;
  return {
      {"--machine", &A::machine, "machine file: kinematic chain, travels, datum", Need::required},
      {"--volume-um", &A::volume_um,
       "expanded uncertainty (k = 2) to reach: of the error vector, as rms over the volume and all tools [um]",
       Need::required, Range{0.01, 1e6}},
      {"--instrument", &A::instrument,
       "instrument: tracking interferometer, laser interferometer or telescoping ball bar",
       Words{"tracker", "interferometer", "ball_bar"}},
      {"-o,--output", &A::output, "plan to write (.csv), for manual measurement or `ecs-emulator lengths`", Is::output},
      {"--tools", &A::tools,
       "offsets of the reflector, one for each tool, as in 0,0,-250;150,0,-120 [mm]; default: 0,0,0"},
      {"--stations", &A::stations,
       "permitted positions of the instrument, as in -250,-200,-750;1450,800,-700 [mm]; default: around the volume, "
       "for a "
       "ball bar within it"},
      {"--knots", &A::knots,
       "distance between the knots (points) of the error curves of X,Y,Z [mm]; default: a twelfth of the travel"},
      {&A::settings,
       cli::Fields<S>{
           {"--reversal-degree", &S::reversal_degree,
            "degree of the polynomial that describes the reversal error along an axis", Range{0, 6}},
           {"--instrument-um", &S::instrument_um, "standard deviation of a reading [um]", Range{0.001}},
           {"--scatter-um", &S::scatter_um,
            "standard deviation of the position at which the machine stops, each axis and direction [um]", Range{0.0}},
           {"--scatter-um-per-m", &S::scatter_um_per_m, "standard deviation of the machine's angles at a stop [um/m]",
            Range{0.0}},
           {"--scale", &S::scale_um_per_m, "standard uncertainty of the scale of each set-up [um/m]", Range{0.0}},
           {"--ball-bar-mm", &S::ball_bar_mm, "nominal length of the ball bar [mm]", Range{1.0}},
           {"--bar-um", &S::bar_um,
            "standard uncertainty of the actual length of the ball bar [um]; 0: the length is not known", Range{0.0}},
           {"--bar-lowest-deg", &S::bar_lowest_deg, "lowest elevation that the post of the ball permits [deg]",
            Range{-90.0, 0.0}},
           {"--targets", &S::targets_an_interval,
            "number of targets between two knots of a line; each line gets four additional targets", Range{0.1, 10.0}},
           {"--feed", &S::feed_mm_min, "feed between targets [mm/min]", Range{1.0}},
           {"--dwell", &S::dwell_s, "dwell before each reading [s]", Range{0.0}}}},
      {"--set-up-minutes", &A::set_up_minutes, "time to move the instrument to another station or line", Range{0.0}},
      {&A::settings, cli::Fields<S>{{"--tool-minutes", &S::tool_minutes, "time to change the tool at the same station",
                                     Range{0.0}}}}};
}

Result<model::LengthPlan> lengths_plan(const LengthsPlanAsked& asked, const std::function<bool()>& stopped) {
  ECS_TRY(machine, params::read_machine(asked.machine));
  ECS_TRY(settings, settings_of(asked));
  settings.stopped = stopped;
  auto plan = model::planned_lengths(machine.machine, settings);
  if (plan && stopped && stopped()) return problem(ProblemKind::refused, "stopped: no plan was made");
  return plan;
}

double greatest_in(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (const auto* list : {&a, &b})
    for (const double value : *list) most = std::max(most, std::abs(value));
  return most;
}

template <class Identified>
std::optional<double> freedom_of(const Identified& one) {
  return one.determined ? std::optional(one.degrees_of_freedom) : std::nullopt;
}

Cell curve_cell(const model::IdentifiedCurve& curve) {
  const std::string unit(unit_of(curve.component));
  Json points = object_of("position_mm"_is(curve.position_mm), "forward"_is(curve.forward), "reverse"_is(curve.reverse),
                          "U_forward"_is(curve.U_forward), "U_reverse"_is(curve.U_reverse));
  if (!curve.determined) points = nullptr;
  const auto number = [&](double value) {
    return number_cell(curve.determined ? std::optional(value) : std::nullopt, 2);
  };
  return record_cell("  {component:<4} {description:<38} {unit:<4} {largest:>8} {reversal:>9} {U_largest:>9}\n",
                     "component"_is(name_of(curve.component)), "description"_is(laser::description_of(curve.component)),
                     "unit"_is(unit), "determined"_is(curve.determined),
                     "largest"_is(number(greatest_in(curve.forward, curve.reverse))), "reversal"_is([&] {
                       std::vector<double> reversal;
                       for (std::size_t i = 0; i < curve.forward.size(); ++i)
                         reversal.push_back(curve.forward[i] - curve.reverse[i]);
                       return number(greatest_in(reversal, {}));
                     }()),
                     "U_largest"_is(number(greatest_in(curve.U_forward, curve.U_reverse))),
                     "degrees_of_freedom"_is(freedom_of(curve), 1), "points"_is(std::move(points)));
}

Cell square_cell(const model::IdentifiedSquareness& square) {
  const auto number = [&](double value) {
    return number_cell(square.determined ? std::optional(value) : std::nullopt, 2);
  };
  return record_cell("  {component:<4} {description:<38} {unit:<4} {um_per_m:>8} {none:>9} {U:>9}\n",
                     "component"_is(name_of(square.component)),
                     "description"_is(laser::description_of(square.component)), "unit"_is("um/m"),
                     "determined"_is(square.determined), "um_per_m"_is(number(square.um_per_m)), "none"_shown(""),
                     "U"_is(number(square.U_um_per_m)), "degrees_of_freedom"_is(freedom_of(square), 1));
}

/// A placement of points.
Cell placement_cell(const model::IdentifiedSetUp& set_up) {
  const auto three = [](const Vector3& v, double unit) {
    return fmt::format("{:.2f}, {:.2f}, {:.2f}", v[0] * unit, v[1] * unit, v[2] * unit);
  };
  const Vector3 shift_mm{-set_up.station_correction_mm[0], -set_up.station_correction_mm[1],
                         -set_up.station_correction_mm[2]};
  return record_cell(
      "  set-up {name}: {readings} deviations, residual {rms_um} um rms, the points lie {shift} um (X, Y, Z) from the "
      "stated place, turned by {turn} um/m\n",
      "name"_is(set_up.name), "readings"_is(set_up.readings), "rms_um"_is(set_up.rms_um, 3),
      "translation_mm"_is(Json(shift_mm)), "shift"_shown(three(shift_mm, kUmPerMm)),
      "rotation_um_per_m"_is(Json(*set_up.turned_um_per_m)), "turn"_shown(three(*set_up.turned_um_per_m, 1.0)));
}

Cell set_up_cell(const model::IdentifiedSetUp& set_up) {
  if (set_up.turned_um_per_m) return placement_cell(set_up);
  return record_cell(
      "  set-up {name}: {readings} readings, residual {rms_um} um rms, station at {shown} mm (X, Y, Z) from the stated "
      "place\n",
      "name"_is(set_up.name), "readings"_is(set_up.readings), "rms_um"_is(set_up.rms_um, 3),
      "station_correction_mm"_is(Json(set_up.station_correction_mm)),
      "shown"_shown(fmt::format("{:.3f}, {:.3f}, {:.3f}", set_up.station_correction_mm[0],
                                set_up.station_correction_mm[1], set_up.station_correction_mm[2])));
}

Cell outlier_cell(const model::LengthOutlier& outlier) {
  return record_cell("  excluded: line {line}, residual {residual_um} um, {sigmas} sigma\n", "line"_is(outlier.line),
                     "residual_um"_is(outlier.residual_um, 2), "sigmas"_is(outlier.sigmas, 1));
}

std::vector<std::string> missing_in(const model::Identification& found) {
  std::vector<std::string> out;
  for (const auto& curve : found.curves)
    if (!curve.why_not.empty()) out.push_back(curve.why_not);
  for (const auto& square : found.squareness)
    if (!square.why_not.empty()) out.push_back(square.why_not);
  return out;
}

std::vector<std::string> without_effect(const model::Identification& found) {
  std::vector<std::string> out;
  for (const auto& curve : found.curves)
    if (!curve.acts) out.emplace_back(name_of(curve.component));
  return out;
}

std::string idle_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty()
             ? text
             : fmt::format("  not determined: {}. They act only through a tool offset, and none was used\n", text);
}

/// One component after the other, each with its own set-up.
Cell single_cell(const model::SingleSetUps& single, double U_um, double minutes) {
  return record_cell(
      "to measure each component on its own with U = {wanted} um{not_reached} takes {set_ups} set-ups ({runs} "
      "{runs_word} "
      "of {targets} targets each) and {minutes} minutes; this plan takes {percent} % of that time\n",
      "wanted"_shown(U_um, 3), "set_ups"_is(single.set_ups), "runs"_is(single.runs), "targets"_is(single.targets),
      "minutes"_is(single.minutes, 1), "volume_U_um"_is(single.volume_U_um, 3), "reached"_is(single.reached),
      "ratio"_is(minutes / single.minutes), "percent"_shown(100.0 * minutes / single.minutes, 0),
      "runs_word"_shown(single.runs == 1 ? "run" : "runs"),
      "not_reached"_shown(single.reached ? "" : " (not reached)"));
}

/// " and 3 values known beforehand: the length scale of the instrument in each set-up (option --scale)"
std::string known_text(const LengthsWork& work) {
  const int known = work.found.known_values;
  if (known == 0) return {};
  const bool bar = work.test.bar_um && std::ranges::any_of(work.test.set_ups, [](const model::LengthSetUp& set_up) {
                     return set_up.instrument == model::LengthInstrument::ball_bar;
                   });
  const bool scales = known > (bar ? 1 : 0);
  return fmt::format(" and {} value{} known beforehand: {}{}{}", known, known == 1 ? "" : "s",
                     scales ? "the length scale of the instrument in each set-up (option --scale)" : "",
                     scales && bar ? " and " : "", bar ? "the length of the ball bar (# bar_um)" : "");
}

/// Uncertainties are expanded (95 %). @param map, params_out  files that were written; empty: none
Cell lengths_cell(const LengthsWork& work, const std::string& map, const std::string& params_out) {
  const model::Identification& found = work.found;
  std::vector<model::IdentifiedCurve> acting;
  for (const auto& curve : found.curves)
    if (curve.acts) acting.push_back(curve);
  const std::string none = found.whole() ? "map not written: give --params and -o map.csv\n"
                                         : "map not written: some components are not determined\n";
  return record_cell(
      "{file}: {readings} {of_kind}{known_values}. {unknowns} unknowns, {degrees_of_freedom} degrees of "
      "freedom\n{components}{squareness}{without_effect}{not_determined}"
      "  standard deviation of a single reading {residual_um} um{repeated}\n"
      "  its contributions (added as squares): the instrument {white_um} um; the scatter of each axis at each stop "
      "{stop_um} um and {stop_um_per_m} um per metre of lever; the scatter of each axis from pass to pass (one run in "
      "one direction) {pass_um} um and {pass_um_per_m} um per metre of lever\n"
      "  expanded uncertainty of the error vector of the map: U = {volume_U_um} um (k = 2), root mean square over the "
      "volume. `ecs volume` states the remaining error after compensation\n{set_ups}{outliers}{notes}{map}{params_out}",
      "file"_is(work.test.source), "machine"_is(work.machine_name), "readings"_is(found.readings),
      "of_kind"_shown(model::has_points(work.test) ? "deviations" : "lengths"), "unknowns"_is(found.unknowns),
      "known_values"_is(found.known_values, known_text(work)), "degrees_of_freedom"_is(found.degrees_of_freedom),
      "knots_mm"_is(Json(found.knots_mm)), "determined"_is(found.whole()),
      "components"_is(
          list_cell(acting, curve_cell,
                    fmt::format("  Largest: largest absolute error along the travel. Reversal: largest absolute\n"
                                "  difference of forward and reverse. U: largest expanded uncertainty\n  {:<4} {:<38} "
                                "{:<4} {:>8} {:>9} {:>9}\n",
                                "", "component", "unit", "largest", "reversal", "U (95 %)"))),
      "squareness"_is(list_cell(found.squareness, square_cell)),
      "without_effect"_is(Json(without_effect(found)), idle_text(without_effect(found))),
      "not_determined"_is(lines_cell(missing_in(found), "  ")), "residual_um"_is(found.residual_um, 3),
      "white_um"_is(found.white_um, 3), "stop_um"_is(found.stop_um, 3), "stop_um_per_m"_is(found.stop_um_per_m, 3),
      "pass_um"_is(found.pass_um, 3), "pass_um_per_m"_is(found.pass_um_per_m, 3), "repeat_um"_is(found.repeat_um, 3),
      "repeated"_shown(found.repeat_um ? fmt::format(", of repeated poses {:.3f} um", *found.repeat_um) : ""),
      "volume_U_um"_is(found.volume_U_um, 3), "set_ups"_is(list_cell(found.set_ups, set_up_cell)),
      "outliers"_is(list_cell(found.outliers, outlier_cell)), "notes"_is(lines_cell(found.notes, "  note: ")),
      "map"_is(written_cell("map", map, none)), "params_out"_is(written_cell("parameters", params_out)));
}

std::string unreached_advice(const model::LengthPlan& plan) {
  if (plan.reached) return "";
  return plan.single.reached && plan.single.minutes < plan.minutes
             ? "This instrument cannot reach the wanted uncertainty, and single set-ups are faster for the same: use "
               "another instrument, or those\n"
             : "This instrument cannot reach the wanted uncertainty: use another instrument, or accept a larger one\n";
}

/// "at X 100, Y 0, Z 250 mm"; of an interferometer its direction.
std::string place_words(const model::LengthSetUp& one) {
  const std::string place = fmt::format("X {:.6g}, Y {:.6g}, Z {:.6g}", one.place[0], one.place[1], one.place[2]);
  return one.instrument == model::LengthInstrument::interferometer ? "along the direction " + place
                                                                   : "at " + place + " mm";
}

/// The answer of `ecs lengths plan`. @param file  that was written; empty: none
Cell lengths_plan_cell(const model::LengthPlan& plan, double wanted_U_um, const std::string& file) {
  const auto set_up = [&](const model::LengthSetUp& one) {
    return record_cell("  set-up {name}: {instrument} {place}\n", "name"_is(one.name),
                       "instrument"_is(model::word_of(one.instrument)), "place"_is(Json(one.place), place_words(one)));
  };
  Cell stations = list_cell(plan.test.set_ups, set_up);
  if (!plan.reached) stations.text.clear();  // no plan to follow
  const bool one_tool = plan.test.tools.size() == 1;
  return record_cell(
      one_tool ? "{reached_text}: U = {volume_U_um} um over the volume (wanted {wanted_U_um})\n{minutes} minutes, of "
                 "which {set_up_minutes} for {set_ups} set-ups; {paths} paths with {readings} readings in all\n"
                 "{advice}{stations}{notes}for comparison: {single}{plan}"
               : "{reached_text}: U = {volume_U_um} um over the volume and the tools (wanted {wanted_U_um}), "
                 "{first_tool_U_um} um with the first tool\n{minutes} minutes, of which {set_up_minutes} for {set_ups} "
                 "set-ups; {paths} paths with {readings} readings in all\n{advice}{stations}{notes}for comparison: "
                 "{single}  with the first tool alone: {single_first_tool}{plan}",
      "reached_text"_shown(plan.reached ? "reached" : "NOT REACHED with three runs of every path"),
      "advice"_shown(unreached_advice(plan)), "reached"_is(plan.reached), "wanted_U_um"_is(wanted_U_um, 3),
      "volume_U_um"_is(plan.volume_U_um, 3), "first_tool_U_um"_is(plan.first_tool_U_um, 3),
      "minutes"_is(plan.minutes, 1), "set_up_minutes"_is(plan.set_up_minutes, 1), "set_ups"_is(plan.set_ups),
      "paths"_is(plan.paths), "readings"_is(plan.test.readings.size()), "stations"_is(stations),
      "not_determined"_is(Json(plan.undetermined)), "notes"_is(lines_cell(plan.notes, "note: ")),
      "single"_is(single_cell(plan.single, plan.volume_U_um, plan.minutes)),
      "single_first_tool"_is(single_cell(plan.single_first_tool, plan.first_tool_U_um, plan.minutes)),
      "plan"_is(written_cell("plan", file, "plan not written: give -o plan.csv\n")));
}

cli::Fields<LengthsCompared> LengthsCompared::fields() {
  using A = LengthsCompared;
  using cli::Need, cli::Range;
  return {
      {"MAP", &A::map, "error map (.csv)", Need::required},
      {"LENGTHS", &A::file, "measured lengths that had no part in the map (.csv)", Need::required},
      {"--params", &A::params, "parameters that belong to the map: squareness, convention, measurement lines",
       Need::required},
      {"--at-least", &A::at_least_percent, "required agreement [%]; below it the exit code is 1", Range{0.0, 100.0}}};
}

std::string repeats_text(const model::LengthComparison& found) {
  if (!found.repeat_um) return "  no length is measured in two runs: the scatter is not known\n";
  constexpr double kMuchMore = 1.3;  // as in the notes of `lengths fit`: scatter from a few repeats is known to a fifth
  return fmt::format("  repeated poses scatter by {:.2f} um: {}\n", *found.repeat_um,
                     found.left_um > kMuchMore * *found.repeat_um
                         ? "the residuals are larger, so the map lacks something"
                         : "the residuals are no more than that");
}

/// @param objections        to the map with these parameters: what it lacks counts as 0
/// @param at_least_percent  0: nothing is required
Cell compared_cell(const std::string& map, const model::LengthTest& test, const model::LengthComparison& found,
                   const std::vector<std::string>& objections, double at_least_percent, bool holds) {
  const auto set_up = [](const model::ComparedSetUp& one) {
    return record_cell(
        "  set-up {set_up}, tool {tool}: {readings} lengths, measured {error_um} um, residual {left_um} um\n",
        "set_up"_is(one.name), "tool"_is(one.tool), "readings"_is(one.readings), "error_um"_is(one.error_um, 2),
        "left_um"_is(one.left_um, 2), "station_correction_mm"_is(Json(one.station_correction_mm)));
  };
  const auto length = [](const model::ComparedLength& one) {
    return record_cell("  line {line}: measured {error_um} um, residual {left_um} um\n", "line"_is(one.line),
                       "error_um"_is(one.error_um, 2), "left_um"_is(one.left_um, 2));
  };
  return record_cell(
      "{map} reduces the standard deviation of {file} by {agreement_percent} %, from {error_um} to {left_um} um "
      "({readings} lengths; {unknowns} unknowns of the set-ups fitted: zeros, positions of the "
      "tracker)\n{repeat_text}{set_ups}the lengths that fit "
      "worst:\n{worst}{objections}{verdict}",
      "map"_is(map), "file"_is(test.source), "readings"_is(found.readings), "unknowns"_is(found.unknowns),
      "agreement_percent"_is(100.0 * found.agreement(), 1), "error_um"_is(found.error_um, 2),
      "left_um"_is(found.left_um, 2), "repeat_um"_is(found.repeat_um, 2), "repeat_text"_shown(repeats_text(found)),
      "set_ups"_is(list_cell(found.set_ups, set_up)), "worst"_is(list_cell(found.worst, length)),
      "objections"_is(lines_cell(objections, "the map: ")), "at_least_percent"_is(at_least_percent, 1),
      "holds"_is(holds),
      "verdict"_shown(at_least_percent > 0.0
                          ? fmt::format("required: {:g} %: {}\n", at_least_percent, holds ? "reached" : "NOT REACHED")
                          : std::string()));
}

Result<Outcome> compare_the_lengths(VerbContext&, const LengthsCompared& a) {
  ECS_TRY(map, laser::read_map_csv(a.map));
  ECS_TRY(unit, params::read_whole_parameters(a.params));
  ECS_TRY(text, read_file_of(FileKind::lengths, a.file));
  ECS_TRY(test, model::parse_lengths(text, a.file));
  if (const auto other = laser::other_machine({test.machine, ""}, {map.header.machine, ""}, "the map is of"))
    return tl::unexpected(Problem{ProblemKind::refused, *other, a.file, 0, 0, {}});
  const std::string_view chain = configuration_of(unit.parameters);
  if (!map.header.configuration.empty() && map.header.configuration != chain)
    return problem_at(a.params, 0, 0, "expected the parameters of a machine {} as in the map, found {}",
                      map.header.configuration, chain);
  constexpr std::size_t kWorst = 5;
  ECS_TRY(found, model::compared_lengths(test, map, unit.parameters, kWorst));
  const std::vector<std::string> objections = objections_in(laser::findings_for(map, unit.parameters));
  const bool holds = a.at_least_percent == 0.0 || 100.0 * found.agreement() >= a.at_least_percent;
  return outcome_of(compared_cell(a.map, test, found, objections, a.at_least_percent, holds),
                    holds ? kDone : kDoesNotHold);
}

Result<Outcome> fit_lengths(VerbContext&, const LengthsArguments& a) {
  if (const auto wrong = wrong_date(a.date)) return problem(ProblemKind::usage, "--date: " + *wrong);
  if ((!a.output.empty() || !a.params_out.empty()) && a.params.empty())
    return problem(ProblemKind::usage, "--params is required for a map: the parameters of the unit to be compensated");
  for (const std::string& output : {a.output, a.params_out})
    ECS_DO(check_output_not_input(output, {a.file, a.machine, a.params}));
  ECS_TRY(work, lengths_work(a));
  const bool writes = work.map.has_value();
  if (writes && !a.output.empty()) ECS_DO(write_file(a.output, laser::to_map_csv(*work.map)));
  if (writes && !a.params_out.empty())
    ECS_DO(params::write_parameters(a.params_out, work.unit->parameters, work.unit->identity));
  return outcome_of(lengths_cell(work, writes ? a.output : "", writes ? a.params_out : ""),
                    work.found.whole() ? kDone : kDoesNotHold);
}

Result<Outcome> plan_the_lengths(VerbContext&, const LengthsPlanAsked& a) {
  ECS_DO(check_output_not_input(a.output, {a.machine}));
  ECS_TRY(plan, lengths_plan(a, [] { return interrupted().load(); }));
  if (!a.output.empty()) ECS_DO(write_file(a.output, model::to_csv(plan.test, true)));
  return outcome_of(lengths_plan_cell(plan, a.volume_um, a.output), plan.reached ? kDone : kDoesNotHold);
}

}  // namespace

extern const std::vector<Action> kLengths{
    action("lengths fit",
           "identify the 21 components from lengths or points, with uncertainties; shows which are determined",
           "ecs lengths fit lengths.csv --machine machine.toml --params parameters.toml -o map.csv --params-out "
           "measured.toml",
           fit_lengths),
    action("lengths plan",
           "plan the length measurements that reach a required uncertainty of the error in the volume in the shortest "
           "time",
           "ecs lengths plan --machine machine.toml --volume-um 2 -o plan.csv", plan_the_lengths),
    action("lengths compare", "show how well a map predicts lengths that had no part in it, and where it fails",
           "ecs lengths compare map.csv lengths.csv --params measured.toml --at-least 84", compare_the_lengths)};

}  // namespace ecs::app
