// Every effect of the library, alone in an emulated machine: what the unit compensates, before and after, through
// `map build --from-model`; what is repaired, before and after; and of the rest the reason why the unit cannot
// compensate it. docs/compensated_effects.md is the table of what was measured here. The emulator's effects share no
// code with the library.
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/models/view.hpp"
#include "model/data/path.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/effects/definition.hpp"
#include "tests/support/folder.hpp"
#include "tests/thermal_mill/mill.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

using commissioning::MapFromModel;
using laser::MeasurementSet;

/// Rms of an effect that is alone in a machine.
struct Shown {
  double before_um = 0.0;
  std::optional<double> after_um{};  ///< nothing: the unit cannot compensate it
};

std::string table_of_effect(std::string_view id, const std::string& keys) {
  return fmt::format("[[effect]]\nid = \"{}\"\n{}\n", id, keys);
}

/// `ecs map build --from-model`, for a machine that is otherwise exact.
Result<MapFromModel> map_built(const std::string& machine, const std::string& model) {
  const Folder folder;
  commissioning::NoMessages messages;
  auto built = planned_map_from_model(messages, {.model = folder.with("model.toml", model),
                                                 .machine = folder.with("machine.toml", machine),
                                                 .zero_missing = "exact in this test"});
  if (built) built->compiled.map.header.serial_number = EmulatorSettings{}.serial_number;
  return built;
}

std::vector<std::uint8_t> image_of(const MapFromModel& built) {
  return must(laser::image_of(built.compiled.map, built.parameters.parameters)).bytes;
}

/// Of a machine without an error map: all of it is 0.
std::vector<std::uint8_t> no_map() {
  const WorkshopMachine machine = machine_with_inputs();
  return image_from("", machine.machine, machine.settings.serial_number, true);
}

double root_um(double square_um2) { return std::sqrt(square_um2); }

// What tables of the map, or a squareness, compensate.

Shown by_map(const std::string& errors, const std::string& model) {
  const auto rms_um = [&](const std::vector<std::uint8_t>& image) {
    return root_um(Mill(machine_with_inputs(), errors_of(errors), image).square_um2());
  };
  return {rms_um(no_map()), rms_um(image_of(must(map_built(inputs_text(), model))))};
}

// What thermal rows compensate: over hours in a warm workshop, with a workpiece from the fourth step on.

constexpr const char* kWarmWorkshop = R"(
[air]
mean_degC = 21.0
swing_degC = 5.0
[column]
lag_s = 5400.0
[material]
lag_s = 1800.0
start_degC = 15.0
[spindle]
lag_s = 1200.0
degC_per_1000_rpm = 3.0
steps = [[0, 4000], [5400, 0]]
[sensor.material]
of = "material"
lag_s = 20.0
[sensor.front]
of = "column"
lag_s = 60.0
[sensor.spindle]
of = "spindle"
lag_s = 30.0
)";

void hours_or_passes(Mill& mill, bool warms_by_motion, int step) {
  mill.load(step < 3 ? 0.0 : 400.0);
  if (!warms_by_motion) REQUIRE(mill.simulation.dwell(1200.0));
  for (int pass = 0; warms_by_motion && pass < 8; ++pass) {
    REQUIRE(mill.simulation.move_to({-450.0, -200.0, -150.0}, 3000.0));
    REQUIRE(mill.simulation.move_to({-50.0, -200.0, -150.0}, 3000.0));
  }
}

Shown by_rows(const std::string& effect, const std::string& model, bool warms_by_motion = false) {
  constexpr int kSteps = 8;
  const std::string errors = kWarmWorkshop + effect;
  const Simulation cold(machine_with_inputs(), errors_of(errors), 1);
  const std::string origin =
      fmt::format("[origin]\ntemperatures = {{ t_spindle_degC = {:.6f} }}\n", cold.heat().first_degC_at(2));
  const auto rms_um = [&](const std::vector<std::uint8_t>& image) {
    Mill mill(machine_with_inputs(), errors_of(errors), image);
    double sum = 0.0;
    for (int step = 0; step < kSteps; ++step) {
      hours_or_passes(mill, warms_by_motion, step);
      sum += mill.square_um2();
    }
    CHECK(mill.unit.fault() == Fault::none);
    return root_um(sum / kSteps);
  };
  return {rms_um(no_map()), rms_um(image_of(must(map_built(inputs_text(), model + origin))))};
}

// Faults of the map in the unit: found from readings taken while it compensates, and put right where they are.

const char* const kWithMap =
    "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m = -32.0 }\n"
    "[[effect]]\nid = \"cyclic\"\naxis = \"X\"\nsense = \"EX\"\n"
    "parameters = { period_mm = 130.0, amplitude_um = 6.0, phase_rad = 0.7 }\n"
    "[[effect]]\nid = \"backlash\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { um = 9.0 }\n";

/// A line of X both ways, while the unit compensates.
MeasurementSet compensated_line(Mill& mill) {
  MeasurementSet set;
  for (const Approach approach : {Approach::reverse, Approach::forward}) {
    REQUIRE(mill.simulation.move_to({approach == Approach::reverse ? 0.0 : -500.0, 0.0, 0.0}, 0.0));
    for (int target = 0; target <= 40; ++target) {
      const double x_mm = approach == Approach::reverse ? -12.0 * target - 5.0 : 12.0 * target - 485.0;
      REQUIRE(mill.simulation.move_to({x_mm, 0.0, 0.0}, 0.0));
      set.readings.push_back({.row = static_cast<int>(set.readings.size()) + 1,
                              .axis = Axis::X,
                              .position_mm = {x_mm, 0.0, 0.0},
                              .sense = Sense::EX,
                              .error = mill.simulation.tool_now(false).error_um[0],
                              .approach = approach,
                              .compensated = true});
    }
  }
  return set;
}

struct FaultOfMap {
  std::string errors = kWithMap, model = kWithMap;
  std::string effect;                               ///< that the readings show, as in a model file
  std::function<void(MapFromModel&)> spoil;         ///< the unit begins with
  std::function<void(MapFromModel&, double)> mend;  ///< @param size  of the effect, from the readings
};

Shown by_parameters(const FaultOfMap& fault) {
  MapFromModel built = must(map_built(inputs_text(), fault.model));
  model::Model found = must(model::parse_model(fault.effect, "found.toml", "."));
  found.map = built.compiled.map;
  fault.spoil(built);
  Mill wrong(machine_with_inputs(), errors_of(fault.errors), image_of(built));
  const double before_um = root_um(wrong.square_um2());

  const MeasurementSet set = compensated_line(wrong);
  const model::Fit fit = must(model::fit(found, model::observations_of(set, found, machine_with_inputs().machine)));
  const model::EffectFit& one = only(fit.effects);
  CHECK(fit.rms_um <= 0.1 * one.rms_um);
  const auto& sizes = one.effect.fitted;
  fault.mend(built, sizes.empty() ? 0.0 : sizes.begin()->second);
  Mill right(machine_with_inputs(), errors_of(fault.errors), image_of(built));
  return {before_um, root_um(right.square_um2())};
}

AxisParameters& x_of(MapFromModel& built) { return built.parameters.parameters.axes[0]; }

void exchange_directions(MapFromModel& built) {
  for (laser::MapTable& table : built.compiled.map.tables)
    if (table.approach != Approach::unknown)
      table.approach = table.approach == Approach::forward ? Approach::reverse : Approach::forward;
  std::stable_sort(built.compiled.map.tables.begin(), built.compiled.map.tables.end(),
                   [](const auto& a, const auto& b) {
                     return a.component < b.component || (a.component == b.component && a.approach > b.approach);
                   });
}

/// ECX, which was measured with a level, and EXX as it was measured on the line y = -300 mm: there it holds ECX x 300
/// mm.
FaultOfMap map_of_another_line() {
  const char* const kAngle = "p_mm = [-500.0, -250.0, 0.0]\nvalue = [40.0, -20.0, 0.0]\n";
  return {.errors = "[[effect]]\nid = \"angular\"\ncode = \"ECX\"\npoints = [[-500, 40.0], [-250, -20.0], [0, 0.0]]\n",
          .model =
              "[[effect]]\nid = \"angular\"\ncode = \"ECX\"\n"
              "curve = { p_mm = [-500.0, -250.0, 0.0], value = [40.0, -20.0, 0.0] }\n"
              "[[effect]]\nid = \"progressive\"\naxis = \"X\"\nsense = \"EX\"\n"
              "curve = { p_mm = [-500.0, -250.0, 0.0], value = [12.0, -6.0, 0.0] }\n",
          .effect = std::string("[[known]]\ncode = \"ECX\"\n") + kAngle +
                    "[[effect]]\nid = \"measurement_line\"\naxis = \"X\"\nsense = \"EX\"\ncode = \"ECX\"\n",
          .spoil = [](MapFromModel&) {},
          .mend = [](MapFromModel& built,
                     double lever_mm) { built.parameters.parameters.measurement_lines_mm[0][1] += lever_mm; }};
}

// What the readings show and the unit cannot or must not compensate.

double rms_um(const MeasurementSet& set) {
  double sum = 0.0;
  for (const laser::Reading& reading : set.readings) sum += reading.error * reading.error;
  return root_um(sum / static_cast<double>(set.readings.size()));
}

/// The first effect explains the readings of the machine, what-if leaves it whole with the reason of the library, and
/// `map build --from-model` refuses with that reason.
void check_left_out(const MeasurementSet& readings, const std::string& effects, const std::string& machine) {
  MeasurementSet set = readings;
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  const model::Model model = must(model::parse_model(effects, "model.toml", "."));
  const auto data = model::observations_of(set, model, must(params::parse_machine(machine, "machine.toml")).machine);
  const model::Fit fit = must(model::fit(model, data));
  CHECK(fit.rms_um <= 0.15 * fit.effects.front().rms_um);
  const model::WhatIf what = must(model::what_if(model, data));
  const model::WhatIf::Share& share = what.shares.front();
  CHECK_FALSE(share.carried);
  CHECK(share.how == model.effects.front().definition().how);
  double square = 0.0;
  for (const double um : fit.effects.front().contribution) square += um * um;
  CHECK(what.rms_after_um >= 0.9 * root_um(square / static_cast<double>(data.size())));
  model::Model alone = model::with_values(model, fit);
  alone.effects.resize(1);
  CHECK(contains(to_text(must_fail(map_built(machine, to_toml(alone)))), share.how));
}

/// Readings of a machine with the effect, and of the same after the repair.
Shown repaired(const MeasurementSet& before, const MeasurementSet& after, const std::string& effect,
               const std::string& machine) {
  check_left_out(before, effect, machine);
  return {rms_um(before), rms_um(after)};
}

Shown left_out(const MeasurementSet& set, const std::string& effect, const std::string& machine) {
  check_left_out(set, effect, machine);
  return {rms_um(set)};
}

/// A line of a machine, exact but for `errors`, with `instruments` in its [emulator.laser].
struct Line {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  std::string errors{}, instruments{};
  bool on_the_fly = false;
  double dwell_s = 1.0;
  InstrumentSetting setting{};
  std::optional<InstrumentKind> instrument{};
};

MeasurementSet readings_of(const Line& line) {
  const WorkshopMachine machine = machine_of(ideal_machine() + kPerfectInstruments + line.instruments);
  Simulation shop(machine, errors_of(line.errors), 1);
  const MeasurementPlan plan{.axis = line.axis,
                             .sense = line.sense,
                             .instrument = line.instrument,
                             .targets_mm = targets_between(0.0, line.axis == Axis::X ? -500.0 : -400.0, 20.0),
                             .runs = 2,
                             .dwell_s = line.dwell_s,
                             .on_the_fly = line.on_the_fly,
                             .setting = line.setting};
  MeasurementSet set = must(measure(shop, plan));
  for (laser::Reading& reading : set.readings)  // as the import of a scan derives it
    if (line.on_the_fly)
      reading.extras["speed_mm_min"] = plan.feed_mm_min * static_cast<double>(static_cast<int>(reading.approach));
  return set;
}

// Artefacts, turned over.

Shown turned_over(const std::string& id, const std::string& errors, const Line& line) {
  const auto in_position = [&](bool reversed) {
    Line one = line;
    one.errors = errors;
    one.setting.reversed = reversed;
    return readings_of(one);
  };
  MeasurementSet both = in_position(false), mean = both;
  const MeasurementSet turned = in_position(true);
  for (std::size_t k = 0; k < turned.readings.size(); ++k)
    mean.readings[k].error = 0.5 * (mean.readings[k].error + turned.readings[k].error);
  const double before_um = rms_um(both);
  both.readings.insert(both.readings.end(), turned.readings.begin(), turned.readings.end());
  const std::string place = fmt::format("axis = \"{}\"\nsense = \"{}\"\n", letter_of(line.axis), name_of(line.sense));
  check_left_out(both, table_of_effect(id, place), ideal_machine());
  return {before_um, rms_um(mean)};
}

// A ball on the table of a machine with rotary axes.

/// A head B on a head C; the tool is as far from their axes as it is long.
constexpr const char* kHead = R"(
name = "head"
configuration = "XTYZCB"
[axis.X]
travel_mm = [0.0, 1200.0]
[axis.Y]
travel_mm = [0.0, 800.0]
[axis.Z]
travel_mm = [-600.0, 600.0]
[axis.B]
travel_deg = [-100.0, 100.0]
pivot_mm = [0.0, 0.0, 0.0]
resolution_deg = 0.001
[axis.C]
travel_deg = [-180.0, 180.0]
pivot_mm = [0.0, 0.0, 0.0]
resolution_deg = 0.001
)";

MeasurementSet ball_of(const char* machine, const std::string& errors, BallPlan plan) {
  Simulation simulation(machine_of(machine), errors_of(errors), 1);
  plan.runs = 1;
  plan.noise_um = 0.0;
  return must(ball_readings(simulation, plan));
}

BallPlan on_trunnion() { return {.ball_mm = {780.0, 330.0, -500.0}}; }

/// The head tilts with C at 0, and with C turned.
BallPlan under_head() {
  return {.ball_mm = {600.0, 400.0, 0.0},
          .tool_offset_mm = {0.0, 0.0, -150.0},
          .sweeps = {must(sweep_in("B=-90:90:15")), must(sweep_in("B=-90:90:15/C=90"))}};
}

Shown ball_off(const std::string& id, Vector3 BallPlan::*off) {
  BallPlan wrong = on_trunnion();
  wrong.*off = {12.0, -7.0, 9.0};
  return repaired(ball_of(kTrunnion, "", wrong), ball_of(kTrunnion, "", on_trunnion()), table_of_effect(id, ""),
                  kTrunnion);
}

std::string with_ideal_drives(std::string machine) {
  for (const char* axis : {"X", "Y", "Z"}) machine += fmt::format("[emulator.axis.{}]\ndrive = \"ideal\"\n", axis);
  return machine;
}

/// An error of a rotary axis that readings have shown, compensated by the map of the model that was fitted to them; at
/// the tool, over many places and angles.
Shown by_rotary_axes(MeasurementSet set, const std::string& effect, const std::string& errors, const char* text,
                     const Vector3& tool_mm) {
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  const WorkshopMachine machine = machine_of(with_ideal_drives(text));
  const model::Model model = must(model::parse_model(effect, "model.toml", "."));
  const auto data = model::observations_of(set, model, machine.machine);
  const model::WhatIf what = must(model::what_if(model, data));
  CHECK(only(what.shares).carried);
  CHECK(what.rms_after_um <= 0.1 * what.rms_now_um);
  MapFromModel built = must(map_built(text, to_toml(model::with_values(model, must(model::fit(model, data))))));
  CHECK(built.compiled.not_carried.empty());
  built.parameters.parameters.tool_offset_mm = tool_mm;
  built.parameters.parameters.tool_range_mm = {50.0, 50.0, 200.0};
  declare_rest_zero(built.compiled.map, built.parameters.parameters);
  const auto rms_um = [&](const MapFromModel& with) {
    Mill mill(machine, errors_of(errors), image_of(with));
    return at_turned_tool(mill, machine.machine, tool_mm).rms_um;
  };
  const double after_um = rms_um(built);
  built.compiled.map.header.rotary.clear();
  built.compiled.map.header.rotary_configuration.clear();
  return {rms_um(built), after_um};
}

Shown location_by_ball() {
  const std::string errors = "[location]\nXOC = 20.0\n";
  return by_rotary_axes(ball_of(kTrunnion, errors, on_trunnion()), table_of_effect("location", "code = \"XOC\"\n"),
                        errors, kTrunnion, {});
}

/// @param tool_mm  with which the machine then works
Shown bending_by_ball(const std::string& id, const std::string& contribution, const Vector3& tool_mm) {
  const std::string errors = "[[contribution]]\ncomponent = \"EXB\"\n" + contribution;
  return by_rotary_axes(ball_of(kHead, errors, under_head()), table_of_effect(id, ""), errors, kHead, tool_mm);
}

/// Errors of the linear axes that a ball on the table of a machine with rotary axes has shown, compensated by the map
/// of the model that was fitted to its readings. The readings say nothing of the axes beyond the range in which they
/// follow the ball; a scale and a squareness are the same there.
Shown linear_axes_by_ball() {
  const std::string errors = table_of_effect("scale", "axis = \"X\"\nparameters = { um_per_m = 40.0 }") +
                             table_of_effect("squareness", "code = \"C0Y\"\nparameters = { um_per_m = 25.0 }");
  MeasurementSet set = ball_of(kTrunnion, errors, on_trunnion());
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  const model::Model model = must(model::parse_model(table_of_effect("linear_axes", ""), "model.toml", "."));
  const model::Fit fit = must(model::fit(
      model, model::observations_of(set, model, must(params::parse_machine(kTrunnion, "machine.toml")).machine)));
  const std::string fitted = to_toml(model::with_values(model, fit));
  const WorkshopMachine machine = machine_of(with_ideal_drives(kTrunnion));
  const auto rms_um = [&](const std::vector<std::uint8_t>& image) {
    return root_um(Mill(machine, errors_of(errors), image).square_um2());
  };
  return {rms_um(image_from("", machine.machine, machine.settings.serial_number, true)),
          rms_um(image_of(must(map_built(kTrunnion, fitted))))};
}

Shown scale_of_tilting_axis() {
  const std::string errors = "[[contribution]]\ncomponent = \"EAA\"\nformula = \"0.4*p\"\n";
  Simulation simulation(machine_of(kTrunnion), errors_of(errors), 1);
  const TurnPlan plan{.sweep = must(sweep_in("A=-100:20:10")), .sense = Sense::EA, .runs = 2, .noise = 0.0};
  // counted from the first target, where an offset comes from
  MeasurementSet set = must(turn_readings(simulation, plan));
  for (laser::Reading& reading : set.readings) reading.error += 0.4 * -100.0;
  return by_rotary_axes(set, table_of_effect("tilt_scale", "axis = \"A\"\nsense = \"EA\"\n"), errors, kTrunnion, {});
}

Shown friction_on_circle() {
  std::string machine = small_machine();
  for (const char axis : {'X', 'Y', 'Z'})
    machine += fmt::format("[emulator.axis.{}]\ndrive = \"servo\"\nfriction_Nm = {}\n", axis, axis == 'X' ? 1.0 : 0.02);
  Simulation simulation(machine_of(machine), errors_of(""), 1);
  const CirclePlan plan{.centre_mm = {-250.0, -200.0, -150.0}, .step_deg = 0.25, .runs = 1, .noise_um = 0.0};
  return left_out(model::set_of_circle(must(contour_circle(simulation, plan))),
                  table_of_effect("friction", "axis = \"X\"\nsense = \"EX\"\n"), small_machine());
}

// The table.

struct Row {
  std::string machine;  ///< what is in the emulated machine
  double most = 1.0;    ///< of the rms before that may be left
  std::string reason;   ///< of that share, or what physics would allow
  std::function<Shown()> shown;
};

const char* const kTable = "the output has steps of 0.1 µm, and a table is linear between its values";
const char* const kSteps = "the output has steps of 0.1 µm";
const char* const kJump = "the table has a ramp of one increment in place of the jump";
const char* const kLate = "the sensor lags behind the machine by 20 to 60 s";
const char* const kDuty =
    "the row follows the mean motion of the axis, the emulated machine the time since it was switched on";
const char* const kRight = "the map fits the machine once the parameter is right";
const char* const kAbsent = "exact instruments: without the cause nothing is left";

const std::map<std::string, Row, std::less<>>& rows() {
  static const std::string x = "axis = \"X\"\nsense = \"EX\"\n";
  static const std::string points = "points = [[-500, -6.0], [-300, 4.0], [-200, 5.0], [0, -3.0]]";
  static const std::string curve = "curve = { p_mm = [-500.0, -300.0, -200.0, 0.0], value = [-6.0, 4.0, 5.0, -3.0] }";
  const auto table = [](const std::string& id, const std::string& machine, const std::string& in_machine,
                        const std::string& in_model, const char* reason = kTable) {
    return std::pair(id, Row{machine, 0.1, reason,
                             [=] { return by_map(table_of_effect(id, in_machine), table_of_effect(id, in_model)); }});
  };
  const auto same = [&](const std::string& id, const std::string& machine, const std::string& keys,
                        const char* reason = kTable) { return table(id, machine, x + keys, x + keys, reason); };
  const auto row = [](const std::string& id, const std::string& machine, const std::string& in_machine,
                      const std::string& in_model) {
    const bool of_motion = id == "warm_up";
    const char* const reason = of_motion ? kDuty : id == "load" ? kTable : kLate;
    return std::pair(
        id, Row{machine, of_motion ? 0.25 : 0.05, reason,
                [=] { return by_rows(table_of_effect(id, in_machine), table_of_effect(id, in_model), of_motion); }});
  };
  const auto fault = [](const std::string& id, const std::string& machine, FaultOfMap of) {
    if (of.effect.empty()) of.effect = table_of_effect(id, id == "map_direction_swap" ? "axis = \"X\"\n" : "");
    return std::pair(id, Row{machine, 0.05, kRight, [=] { return by_parameters(of); }});
  };
  const auto line = [](const std::string& id, const std::string& machine, const std::string& keys, const Line& wrong,
                       const Line& right) {
    return std::pair(id, Row{machine, 0.02, kAbsent, [=] {
                               // readings count from the first one
                               const std::string zero =
                                   id == "servo_lag" || id == "delay" ? table_of_effect("offset", x) : "";
                               return repaired(readings_of(wrong), readings_of(right), table_of_effect(id, keys) + zero,
                                               ideal_machine());
                             }});
  };
  const auto not_by_unit = [](const std::string& id, const std::string& machine, std::function<Shown()> shown,
                              const std::string& reason = {}) {
    return std::pair(id, Row{machine, 1.0, reason, std::move(shown)});
  };
  static const std::string warm_air = "[air]\nswing_degC = 6.0\nstart_h = 9.0\n";
  static const std::string slow_drive =
      table_of_effect("servo_lag", "axis = \"X\"\nparameters = { um_per_m_min = 2.0 }");
  static const std::string plate =
      table_of_effect("set_up_rotation", "code = \"EC\"\nparameters = { um_per_m = 40.0 }");
  static const std::map<std::string, Row, std::less<>> all{
      same("offset", "EX of X 7 µm", "parameters = { um = 7.0 }"),
      same("scale", "EX of X -32 µm/m", "parameters = { um_per_m = -32.0 }"),
      same("cyclic", "EX of X ±6 µm, period 130 mm",
           "parameters = { period_mm = 130.0, amplitude_um = 6.0, phase_rad = 0.7 }"),
      same("backlash", "X 9 µm", "parameters = { um = 9.0 }"),
      same("step", "EX of X 11 µm at -170 mm", "parameters = { height_um = 11.0, position_mm = -170.0 }", kJump),
      same("sag", "EX of X 60 µm/m² and -20 µm/m³", "parameters = { k2 = 60.0, k3 = -20.0 }"),
      table("progressive", "EX of X, a curve of 11 µm", x + points, x + curve),
      table("reversal_curve", "lost motion of X, a curve of 11 µm", x + points, x + curve),
      table("angular", "ECX, a curve of 11 µm/m", "axis = \"X\"\ncode = \"ECX\"\n" + points,
            "axis = \"X\"\ncode = \"ECX\"\n" + curve),
      table("squareness", "C0Y 25 µm/m", "code = \"C0Y\"\nparameters = { um_per_m = 25.0 }",
            "code = \"C0Y\"\nparameters = { um_per_m = 25.0 }"),
      row("thermal_scale", "X 11.5 µm/(m °C), bed from 15 to 25 °C",
          "axis = \"X\"\nparameters = { um_per_m_degC = 11.5 }", x + "parameters = { um_per_m_degC = 11.5 }"),
      row("thermal_drift", "EZ -2.4 µm/°C, spindle 12 °C warmer for 90 minutes",
          "axis = \"Z\"\nsense = \"EZ\"\nsensor = \"spindle\"\nparameters = { um_per_degC = -2.4 }",
          "sense = \"EZ\"\nsensor = \"t_spindle_degC\"\nparameters = { um_per_degC = -2.4 }"),
      row("thermal_bend", "EZ of X 20 µm/(m² °C), column against bed",
          "axis = \"X\"\nsense = \"EZ\"\nsensor = \"material\"\nsensor2 = \"front\"\n"
          "parameters = { um_per_m2_degC = 20.0 }",
          "axis = \"X\"\nsense = \"EZ\"\nsensor = \"t_material_degC\"\nsensor2 = \"t_front_degC\"\n"
          "parameters = { um_per_m2_degC = 20.0 }"),
      row("warm_up", "EX of X 8 µm and 15 µm/m, time constant 240 s",
          x + "parameters = { tau_s = 240.0, c_um = 8.0, c_um_per_m = 15.0 }",
          x + "parameters = { tau_s = 240.0, c_um = 8.0, c_um_per_m = 15.0 }"),
      row("load", "EZ over Y -0.01 µm/kg and 0.02 µm/(kg m), 400 kg",
          "axis = \"Y\"\nsense = \"EZ\"\nparameters = { um_per_kg = -0.01, um_per_kg_m = 0.02 }",
          "axis = \"Y\"\nsense = \"EZ\"\nparameters = { um_per_kg = -0.01, um_per_kg_m = 0.02 }"),
      fault("measurement_line", "map of EX measured on y = -300 mm, ECX a curve of 60 µm/m", map_of_another_line()),
      fault("map_polarity", "compensation of X added with the wrong sign",
            {.spoil = [](MapFromModel& built) { x_of(built).compensation_polarity = -1; },
             .mend = [](MapFromModel& built, double) { x_of(built).compensation_polarity = 1; }}),
      fault("map_gain", "output scale of X 1.4 times too large",
            {.spoil = [](MapFromModel& built) { x_of(built).output_scale_counts_per_um *= 1.4; },
             .mend = [](MapFromModel& built, double gain) { x_of(built).output_scale_counts_per_um /= gain; }}),
      fault(
          "map_shift", "reference position of X 25 mm off",
          {.spoil = [](MapFromModel& built) { x_of(built).datum.reference_position_mm -= 25.0; },
           .mend = [](MapFromModel& built, double shift_mm) { x_of(built).datum.reference_position_mm -= shift_mm; }}),
      fault("map_direction_swap", "tables of X for forward and reverse exchanged",
            {.spoil = exchange_directions, .mend = [](MapFromModel& built, double) { exchange_directions(built); }}),
      line("set_up_rotation", "plate turned by 40 µm/m, then aligned", "code = \"EC\"\n",
           {.axis = Axis::Y, .errors = plate}, {.axis = Axis::Y}),
      line("time_drift", "head of the laser creeps by 20 µm/h, then left to warm up", x,
           {.instruments = "head_drift_um_per_h = 20.0\n", .dwell_s = 60.0}, {.dwell_s = 60.0}),
      line("air_refraction", "air compensation off while the air warms from 20 to 25 °C, then automatic", x,
           {.errors = warm_air, .dwell_s = 120.0, .setting = {.air = Compensation::off}},
           {.errors = warm_air, .dwell_s = 120.0}),
      line("dead_path", "dead path of 2 m while the air warms from 20 to 25 °C, then none", x,
           {.errors = warm_air, .dwell_s = 120.0, .setting = {.dead_path_m = 2.0}},
           {.errors = warm_air, .dwell_s = 120.0}),
      line("cosine", "beam 5 mrad off, then aligned", x, {.setting = {.misalignment_mrad = 5.0}}, {}),
      line("servo_lag", "X 2 µm/(m/min) behind on the fly, then at rest", x, {.errors = slow_drive, .on_the_fly = true},
           {.errors = slow_drive}),
      line("delay", "reading 5 ms late on the fly, then at once", x,
           {.on_the_fly = true, .setting = {.trigger_latency_s = 0.005}}, {.on_the_fly = true}),
      {"artefact_angle",
       {"square 12 µm/m off, then the mean of both positions", 0.02, kAbsent,
        [] {
          return turned_over("artefact_angle", "[[artefact]]\naxis = \"Y\"\nsense = \"EX\"\nangle_um_per_m = 12.0\n",
                             {.axis = Axis::Y, .instrument = InstrumentKind::square});
        }}},
      {"artefact_form",
       {"straight edge bent by 4 µm, then the mean of both positions", 0.02, kAbsent,
        [] {
          return turned_over("artefact_form",
                             "[[artefact]]\naxis = \"X\"\nsense = \"EY\"\nformula = \"4*sin(pi*p/500)\"\n",
                             {.sense = Sense::EY, .instrument = InstrumentKind::straightness});
        }}},
      {"ball_on_table",
       {"ball 17 µm off its place, then measured", 0.02, kAbsent,
        [] { return ball_off("ball_on_table", &BallPlan::off_um); }}},
      {"ball_in_spindle",
       {"ball in the spindle 17 µm off, then measured", 0.02, kAbsent,
        [] { return ball_off("ball_in_spindle", &BallPlan::tool_off_um); }}},
      {"location", {"XOC 20 µm, found with a ball", 0.1, kTable, location_by_ball}},
      {"linear_axes", {"scale of X 40 µm/m and C0Y 25 µm/m, found with a ball", 0.1, kTable, linear_axes_by_ball}},
      {"tilt_scale", {"EA of A 0.4 µm/m per degree", 0.1, kTable, scale_of_tilting_axis}},
      {"head_bending",
       {"EX of B 20 µm · sin b, frame of C, found with a ball", 0.1, kTable,
        [] {
          return bending_by_ball("head_bending", "formula = \"20*sin(p*pi/180)\"\n", under_head().tool_offset_mm);
        }}},
      {"machine_bending",
       {"EX of B 20 µm · sin b, frame of the machine, found with a ball", 0.1, kSteps,
        [] {
          return bending_by_ball("machine_bending", "formula = \"20*sin(p*pi/180)\"\nbends = \"machine\"\n",
                                 under_head().tool_offset_mm);
        }}},
      {"tool_bending",
       {"EX of B 100 µm/m · sin b, found with a ball at 150 mm of tool, then a tool of 190 mm", 0.1, kSteps,
        [] {
          return bending_by_ball("tool_bending", "formula = \"100*sin(p*pi/180)\"\nbends = \"tool\"\n",
                                 {30.0, 0.0, -187.6});
        }}},
      not_by_unit("reversal_spike", "X 6 µm after each reversal, decay length 40 mm",
                  [] {
                    const std::string spike =
                        table_of_effect("reversal_spike", "axis = \"X\"\nparameters = { c_um = 6.0, u0_mm = 40.0 }");
                    return left_out(readings_of({.errors = spike}),
                                    table_of_effect("reversal_spike", x) + table_of_effect("offset", x),
                                    ideal_machine());
                  }),
      not_by_unit("friction", "X 1 Nm of friction at the motor, circle of 100 mm", friction_on_circle),
      not_by_unit(
          "user", "EX of X, a formula: 5 µm · (x/500)³",
          [] {
            return left_out(
                readings_of({.errors = "[[contribution]]\ncomponent = \"EXX\"\nformula = \"5*(p/500)^3\"\n"}),
                table_of_effect("user",
                                "name = \"cube\"\nformula = { EX = \"k * (x_mm / 500)^3\" }\n"
                                "parameters = { k = { unit = \"um\" } }\n"),
                ideal_machine());
          },
          "a formula of one position could be a table: measure the line and build the map from the readings"),
  };
  return all;
}

std::string number(double um) {
  constexpr double kNoError_um = 0.005;
  if (um < kNoError_um) return "below 0.005";
  return um < 10.0 ? fmt::format("{:.2g}", um) : fmt::format("{:.0f}", um);
}

/// Word for word, numbers within a tenth: processors differ in the last digits.
bool is_same_page(const std::string& a, const std::string& b) {
  const auto one = split(a, ' '), other = split(b, ' ');
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](std::string_view x, std::string_view y) {
    const auto first = number_in(x), second = number_in(y);
    return x == y || (first && second && std::abs(*first - *second) <= 0.1 * std::abs(*first));
  });
}

std::string page_of(const std::vector<std::string>& lines) {
  return fmt::format(
      "# What becomes of every effect\n\n"
      "Each effect of the library ([physics.md](physics.md#the-effect-library)) was put alone into an emulated "
      "machine. "
      "Before and after are rms\n"
      "errors in µm of that machine. This page is generated by the test `thermal_mill/every_effect`, which measures "
      "the machines.\n\n"
      "- *error map*, *parameters*, *thermal rows*: the unit compensates the effect. The error at the tool is measured "
      "at nine places in the\n"
      "  working volume, over hours for thermal rows, without and with the map that `ecs map build --from-model` "
      "makes; for errors\n"
      "  of rotary axes at 60 places and angles. For faults of the map the column *before* is measured with the fault. "
      "Its "
      "size is then fitted to\n"
      "  readings that are taken while the unit compensates, and the parameter is corrected by this size.\n"
      "  For `linear_axes` the map compensates the scales, the parameters the squareness.\n"
      "- *remove the cause*: an error of the measurement or of the commissioning. The readings are taken with the "
      "cause "
      "and again without it.\n"
      "- *no*: a map made from the model cannot compensate the effect. `ecs model what-if` and `ecs map build` state "
      "the "
      "reason.\n\n"
      "*Limit*: the error after may be at most this percentage of the error before.\n\n"
      "| effect | compensated by | emulated machine | before | after | limit | reason for the limit, or for *no* |\n"
      "|---|---|---|---|---|---|---|\n{}",
      fmt::join(lines, ""));
}

}  // namespace

TEST_CASE("every effect of the library is compensated or repaired in an emulated machine, or the reason is stated") {
  std::vector<std::string> lines;
  for (const model::EffectDefinition& effect : model::effect_library()) {
    const std::string id(effect.id);
    CAPTURE(id);
    const auto found = rows().find(id);
    REQUIRE_MESSAGE(found != rows().end(), "the effect has no row in this test");
    const Row& row = found->second;
    const Shown shown = row.shown();
    CHECK(shown.before_um > 0.5);
    CHECK(shown.after_um.has_value() == (effect.carrier != model::Carrier::none));
    std::string after = "–", limit = "–", reason(effect.how);
    if (shown.after_um) {
      CHECK(*shown.after_um <= row.most * shown.before_um);
      after = number(*shown.after_um);
      limit = fmt::format("{:g} %", 100.0 * row.most);
      reason = row.reason;
    } else if (!row.reason.empty()) {
      reason += ". Note: " + row.reason;
    }
    lines.push_back(fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", id,
                                commissioning::carrier_text(effect.carrier), row.machine, number(shown.before_um),
                                after, limit, reason));
  }
  CHECK(rows().size() == model::effect_library().size());
  const std::string page = page_of(lines);
  if (std::getenv("ECS_WRITE_DOCS") != nullptr) REQUIRE(write_file("docs/compensated_effects.md", page));
  CHECK_MESSAGE(is_same_page(must(read_file("docs/compensated_effects.md")), page),
                "docs/compensated_effects.md is not the page of these machines (ECS_WRITE_DOCS=1 renews it)");
}

TEST_CASE("an effect without its input is left out of the map with the reason") {
  const auto reason = [](const std::string& inputs, const std::string& id, const std::string& keys) {
    const auto machine = machine_of(ideal_machine() + inputs).machine;
    const auto model = must(model::parse_model(table_of_effect(id, keys), "model.toml", "."));
    const auto made = must(model::compiled(model, machine, 50.0));
    CHECK(made.map.header.thermal.empty());
    return only(made.not_carried);
  };
  const std::string drift = "sense = \"EZ\"\nsensor = \"t_spindle_degC\"\nparameters = { um_per_degC = -2.4 }";
  for (const auto& [id, keys] : std::map<std::string, std::string>{
           {"thermal_scale", "axis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m_degC = 11.5 }"},
           {"thermal_drift", drift},
           {"thermal_bend",
            "axis = \"X\"\nsense = \"EZ\"\nsensor = \"t_material_degC\"\nsensor2 = \"t_front_degC\"\n"
            "parameters = { um_per_m2_degC = 20.0 }"},
           {"warm_up", "axis = \"X\"\nsense = \"EX\"\nparameters = { tau_s = 240.0, c_um = 8.0 }"},
           {"load", "axis = \"Y\"\nsense = \"EZ\"\nparameters = { um_per_kg = -0.01 }"}})
    CHECK(contains(reason("", id, keys), "[inputs]"));
  CHECK(contains(reason("[inputs]\nt_spindle_degC = 3\n", "thermal_drift", drift),
                 "the model does not state the temperature of t_spindle_degC at its origin"));
  CHECK(contains(reason("[inputs]\nt_material_degC = 1\n", "thermal_scale",
                        "axis = \"X\"\nsense = \"EB\"\nparameters = { um_per_m_degC = 1.0 }"),
                 "no row for a rotation that changes along its axis"));
}
