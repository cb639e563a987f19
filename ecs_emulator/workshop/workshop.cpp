#include "ecs_emulator/workshop/workshop.hpp"

#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/outcome.hpp"
#include "base/text.hpp"
#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/workshop/actions.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::emulator {

nlohmann::json by_axis(const MachineTool& machine, const Vector3& values) {
  auto object = nlohmann::json::object();
  for (const Axis a : kAllAxes)
    if (machine.has(a)) object[std::string(1, letter_of(a))] = values[index_of(a)];
  return object;
}

namespace {

using Json = nlohmann::json;
using Report = std::function<void(const std::string&)>;
using Answer = Result<Json>;

tl::unexpected<Problem> simulation_stopped_early() { return problem(ProblemKind::refused, "stopped before its end"); }
tl::unexpected<Problem> wrong(std::string message) { return problem(ProblemKind::usage, std::move(message)); }

/// Readings into the file under `output`, or back as `csv` where there is none.
Answer handed_back(std::size_t readings, const std::string& csv, const std::string& output) {
  if (output.empty()) return Json{{"readings", readings}, {"csv", csv}};
  ECS_DO(write_file(output, csv));
  return Json{{"readings", readings}, {"output", output}};
}

Json rack_in(const Unit& unit) {
  Json rack = Json::array();
  for (const RackModule& module : rack_of(unit.settings().memory_modules, unit.settings().axis_modules))
    rack.push_back({{"module", module.name}, {"slot", module.first_slot}, {"slots", module.slots}});
  return rack;
}

Json state_of(const Workshop& workshop) {
  const MachineTool& machine = workshop.simulation->machine();
  Json state{{"command_mm", by_axis(machine, machine.command_mm())},
             {"position_mm", by_axis(machine, machine.state().position_mm)},
             {"time_s", machine.time_s()},
             {"tool", workshop.simulation->tool()},
             {"control_on", workshop.simulation->control_on()},
             {"link", nullptr},
             {"unit", nullptr}};
  if (!workshop.link.empty()) state["link"] = workshop.link;
  for (std::size_t r = 0; r < kAxes; ++r)
    if (workshop.simulation->description().machine.rotary[r])
      state["angle_deg"][std::string(1, "ABC"[r])] = machine.rotary_state().angle_deg[r];
  if (workshop.unit != nullptr)
    state["unit"] = {{"powered", workshop.unit->powered()},
                     {"mode", name_of(workshop.unit->mode())},
                     {"fault", text_of(workshop.unit->fault()).name},
                     {"rack", rack_in(*workshop.unit)}};
  for (const auto& [sensor, degC] : workshop.simulation->sensors_degC(machine.time_s())) {
    if (!state.contains("sensors_degC")) state["sensors_degC"] = Json::object();
    state["sensors_degC"][sensor] = degC;
  }
  if (workshop.simulation->heat().has_air()) {
    const Air air = workshop.simulation->air();
    state["air"] = {{"degC", air.temperature_degC}, {"hPa", air.pressure_hPa}, {"humidity_pct", air.humidity_pct}};
  }
  if (const auto& clock = workshop.simulation->real_time()) {
    const RealTimeRecord& record = clock->record();
    state["real_time"] = {{"periods", record.periods},
                          {"missed", record.missed},
                          {"worst_late_us", std::round(record.worst_late_us)},
                          {"fifo", record.fifo}};
  }
  return state;
}

Answer show(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(arguments.checked());
  return state_of(workshop);
}

/// Where the rotary axes turn to: those that are not named stay.
Vector3 asked_angles(const Simulation& simulation, Arguments& arguments) {
  Vector3 angle_deg = simulation.machine().rotary_state().angle_deg;
  for (std::size_t r = 0; r < kAxes; ++r) {
    const std::string letter(1, "ABC"[r]);
    const auto asked = arguments.number(letter.c_str());
    const auto& axis = simulation.description().machine.rotary[r];
    if (!asked) continue;
    if (!axis)
      arguments.complain("this machine has no {}", letter);
    else if (!(*asked >= axis->travel_deg[0] && *asked <= axis->travel_deg[1]))
      arguments.complain("{}: expected within its travel {} … {} deg, got {}", letter, axis->travel_deg[0],
                         axis->travel_deg[1], *asked);
    angle_deg[r] = *asked;
  }
  return angle_deg;
}

Answer jog(const Workshop& workshop, Arguments& arguments) {
  const auto place = arguments.coordinates(nullptr);
  const double feed = arguments.number_or("feed", 0.0);
  Simulation& simulation = *workshop.simulation;
  Vector3 target_mm = simulation.machine().command_mm();
  for (const Axis a : kAllAxes) {
    if (!place[index_of(a)]) continue;
    if (!simulation.machine().has(a)) arguments.complain("this machine has no {}", letter_of(a));
    target_mm[index_of(a)] = *place[index_of(a)];
    const auto [low_mm, high_mm] = simulation.machine().travel_mm()[index_of(a)];
    if (!(*place[index_of(a)] >= low_mm - kOvertravel_mm && *place[index_of(a)] <= high_mm + kOvertravel_mm))
      arguments.complain("{}: expected within its travel {} … {} mm (tolerance {} mm), got {}", letter_of(a), low_mm,
                         high_mm, kOvertravel_mm, *place[index_of(a)]);
  }
  if (feed != 0.0 && !(feed >= kSlowestFeed_mm_min))
    arguments.complain("feed: expected {} mm/min or more, or 0 for rapid, got {}", kSlowestFeed_mm_min, feed);
  const Vector3 angle_deg = asked_angles(simulation, arguments);
  ECS_DO(arguments.checked());
  simulation.machine().turn_to(angle_deg);
  if (!simulation.move_to(target_mm, feed)) return simulation_stopped_early();
  return state_of(workshop);
}

/// After the last axis the unit gets as long as it needs to make up its mind.
bool wait_for_unit(const Workshop& workshop) {
  const double end_s = workshop.simulation->machine().time_s() + kDatumGiveUp_s + 1.0;
  while (workshop.unit->mode() == UnitMode::datuming && !workshop.unit->quiet() &&
         workshop.simulation->machine().time_s() < end_s)
    if (!workshop.simulation->run_for(0.1)) return false;
  return true;
}

Answer reference_machine(const Workshop& workshop, Arguments& arguments) {
  std::vector<Axis> axes;
  for (const std::string& name : arguments.words("axes")) {
    const auto axis = name.size() == 1 ? axis_of(name.front()) : std::nullopt;
    if (axis && workshop.simulation->machine().has(*axis))
      axes.push_back(*axis);
    else
      arguments.complain("axes: expected an axis of this machine, got \"{}\"", name);
  }
  ECS_DO(arguments.checked());
  if (axes.empty())
    for (const Axis a : kAllAxes)
      if (workshop.simulation->machine().has(a)) axes.push_back(a);
  ECS_DO(reference(*workshop.simulation, axes));
  if (workshop.unit != nullptr && !wait_for_unit(workshop)) return simulation_stopped_early();
  return state_of(workshop);
}

Json point_of(const MachineTool& machine, const SurveyPoint& point) {
  return {{"position_mm", by_axis(machine, point.position_mm)},
          {"error_um", by_axis(machine, point.error_um)},
          {"length_um", point.length_um()}};
}

/// The plane "XY" of a request.
std::array<Axis, 2> circle_plane(const Workshop& workshop, Arguments& arguments) {
  const std::string name = arguments.word("plane");
  const auto first = name.size() == 2 ? axis_of(name[0]) : std::nullopt;
  const auto second = name.size() == 2 ? axis_of(name[1]) : std::nullopt;
  const MachineTool& machine = workshop.simulation->machine();
  if (first && second && first != second && machine.has(*first) && machine.has(*second)) return {*first, *second};
  arguments.complain("plane: expected two axes of this machine, such as XY, got \"{}\"", name);
  return {Axis::X, Axis::Y};
}

Answer read_circle(const Workshop& workshop, Arguments& arguments) {
  CirclePlan plan;
  plan.plane = circle_plane(workshop, arguments);
  const MachineTool& machine = workshop.simulation->machine();
  const auto centre = arguments.coordinates("centre");
  for (const Axis a : kAllAxes) {
    const auto [low_mm, high_mm] = machine.travel_mm()[index_of(a)];
    plan.centre_mm[index_of(a)] = centre[index_of(a)].value_or((low_mm + high_mm) / 2.0);
  }
  arguments.numbers_into({{"radius", &plan.radius_mm},
                          {"feed", &plan.feed_mm_min},
                          {"start", &plan.start_angle_deg},
                          {"overlap", &plan.overlap_deg},
                          {"step", &plan.step_deg}});
  plan.runs = static_cast<int>(arguments.integer("runs", 1, 1000).value_or(plan.runs));
  plan.noise_um = arguments.number_or("noise", plan.noise_um);
  const std::string output = arguments.word("output");
  ECS_DO(arguments.checked());
  ECS_TRY(test, contour_circle(*workshop.simulation, plan));
  return handed_back(test.readings.size(), laser::to_csv(test), output);
}

Answer survey_machine(const Workshop& workshop, Arguments& arguments) {
  SurveyPlan plan;
  plan.step_mm = arguments.number_or("step", plan.step_mm);
  if (!(plan.step_mm > 0.0)) arguments.complain("step: expected above 0 mm");
  plan.scatter = arguments.flag("with_scatter");
  const auto approach = arguments.integer("approach", -1, 1).value_or(1);
  if (approach == 0) arguments.complain("approach: expected 1 or -1");
  plan.approach = approach < 0 ? Approach::reverse : Approach::forward;
  const std::string output = arguments.word("output");
  ECS_DO(arguments.checked());
  ECS_TRY(found, survey(*workshop.simulation, plan));
  const MachineTool& machine = workshop.simulation->machine();
  if (!output.empty()) {
    std::string text = "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um,length_um\n";
    for (const SurveyPoint& p : found.grid)
      text +=
          fmt::format("{},{},{},{:.3f},{:.3f},{:.3f},{:.3f}\n", shortest(p.position_mm[0]), shortest(p.position_mm[1]),
                      shortest(p.position_mm[2]), p.error_um[0], p.error_um[1], p.error_um[2], p.length_um());
    ECS_DO(write_file(output, text));
  }
  Json corners = Json::array();
  for (const SurveyPoint& corner : found.corners) corners.push_back(point_of(machine, corner));
  return Json{{"approach", approach},
              {"with_scatter", plan.scatter},
              {"corners", {{"worst", point_of(machine, worst(found.corners))}, {"all", corners}}},
              {"grid",
               {{"points", found.grid.size()},
                {"worst", point_of(machine, worst(found.grid))},
                {"rms_um", rms_um(found.grid)}}}};
}

/// The lengths of a plan.
Answer read_lengths(const Workshop& workshop, Arguments& arguments) {
  LengthInstrumentSettings settings;
  const std::string plan = arguments.word("plan"), output = arguments.word("output");
  const std::initializer_list<std::pair<const char*, double*>> deviations{
      {"noise", &settings.noise_um}, {"scale", &settings.scale_um_per_m}, {"station", &settings.station_mm},
      {"tool", &settings.tool_mm},   {"zero", &settings.zero_um},         {"bar", &settings.bar_um}};
  arguments.numbers_into(deviations);
  settings.scatter = !arguments.flag("no_scatter");
  for (const auto& [key, deviation] : deviations)
    if (!(*deviation >= 0.0)) arguments.complain("noise, scale, station, tool, zero, bar: expected 0 or more");
  if (workshop.unit != nullptr)
    arguments.complain("lengths: expected a machine without a unit; use `ecs-emulator lengths`");
  ECS_DO(arguments.checked());
  ECS_TRY(text, read_file(plan));
  ECS_TRY(lengths, measured_lengths(*workshop.simulation, text, plan, settings));
  return handed_back(lengths.readings, lengths.csv, output);
}

/// What both kinds of readings of rotary axes share.
void ask_for_readings(Arguments& arguments, int& runs, double& noise, double& seconds) {
  runs = static_cast<int>(arguments.integer("runs", 1, 1000).value_or(runs));
  arguments.numbers_into({{"noise", &noise}, {"seconds", &seconds}});
  if (!(noise >= 0.0)) arguments.complain("noise: expected 0 or more");
  if (!(seconds >= 0.0)) arguments.complain("seconds: expected 0 or more");
}

Sweep asked_sweep(Arguments& arguments, const std::string& text) {
  auto sweep = sweep_in(text);
  if (sweep) return *sweep;
  arguments.complain(sweep.error().message);
  return {};
}

Vector3 asked_vector(Arguments& arguments, const char* key) {
  const std::vector<double> numbers = arguments.numbers(key);
  if (numbers.empty()) return {};
  if (numbers.size() == kAxes) return {numbers[0], numbers[1], numbers[2]};
  arguments.complain("{}: expected three numbers X,Y,Z", key);
  return {};
}

Answer read_ball(const Workshop& workshop, Arguments& arguments) {
  BallPlan plan;
  if (arguments.numbers("ball").empty()) arguments.complain("ball: expected X,Y,Z at which the linear axes touch it");
  plan.ball_mm = asked_vector(arguments, "ball");
  plan.tool_offset_mm = asked_vector(arguments, "tool_offset");
  plan.off_um = asked_vector(arguments, "off");
  plan.tool_off_um = asked_vector(arguments, "tool_off");
  plan.on_workpiece = arguments.flag("on_workpiece");
  plan.drives = workshop.unit != nullptr;
  ask_for_readings(arguments, plan.runs, plan.noise_um, plan.seconds);
  for (const std::string& text : arguments.words("sweep")) plan.sweeps.push_back(asked_sweep(arguments, text));
  const std::string output = arguments.word("output");
  ECS_DO(arguments.checked());
  plan.stand = workshop.simulation->rotary();
  ECS_TRY(set, ball_readings(*workshop.simulation, plan));
  workshop.simulation->rotary() = stand_after(set, plan.stand);
  return handed_back(set.readings.size(), to_csv(set), output);
}

Answer read_turn(const Workshop& workshop, Arguments& arguments) {
  TurnPlan plan;
  plan.sweep = asked_sweep(arguments, arguments.word("sweep"));
  plan.sense = arguments.sense(true).value_or(plan.sense);
  if (workshop.unit != nullptr)
    arguments.complain("turn: expected a machine without a unit, `ecs-emulator turn`; with a unit measure a `ball`");
  ask_for_readings(arguments, plan.runs, plan.noise, plan.seconds);
  const std::string output = arguments.word("output");
  ECS_DO(arguments.checked());
  ECS_TRY(set, turn_readings(*workshop.simulation, plan));
  return handed_back(set.readings.size(), to_csv(set), output);
}

/// Error motions and location errors of the rotary axes that the machine has.
Json true_rotary_components(const Simulation& simulation, const PerAxis<std::vector<double>>& angles_deg) {
  const RotaryComponents found = rotary_components(simulation, angles_deg);
  Json curves = Json::object(), locations = Json::object();
  for (std::size_t r = 0; r < kAxes; ++r) {
    if (!simulation.description().machine.rotary[r]) continue;
    for (std::size_t s = 0; s < 2 * kAxes; ++s) {
      curves[rotary_name(r, static_cast<Sense>(s))] = {{"forward", found.forward[r][s]},
                                                       {"reverse", found.reverse[r][s]}};
      locations[location_name(r, s)] = found.location[r][s];
    }
  }
  return Json{{"components", curves}, {"location", locations}};
}

/// The true components along each axis, the others at the datum: the systematic part, as the machine is now.
Answer true_components(const Workshop& workshop, Arguments& arguments) {
  const PerAxis<std::vector<double>> places{arguments.numbers("x"), arguments.numbers("y"), arguments.numbers("z")};
  const PerAxis<std::vector<double>> angles{arguments.numbers("a"), arguments.numbers("b"), arguments.numbers("c")};
  ECS_DO(arguments.checked());
  ECS_TRY(found, components_along(*workshop.simulation, places));
  Json curves = Json::object(), squareness = Json::object();
  for (std::size_t c = 0; c < kCurves; ++c)
    curves[std::string(kComponentNames[c])] = {{"forward", found.forward[c]}, {"reverse", found.reverse[c]}};
  for (std::size_t c = kCurves; c < kComponents; ++c) squareness[std::string(kComponentNames[c])] = found.squareness[c];
  Json lines = Json::object();
  const MeasurementLines lines_mm = params::measurement_lines_of(workshop.simulation->description().machine);
  for (const Axis a : kAllAxes) lines[std::string(1, letter_of(a))] = lines_mm[index_of(a)];
  Json without = Json::array();
  for (const LeftOut& one : left_out(*workshop.simulation)) {
    Json components = Json::array();
    for (const Component component : one.components) components.push_back(name_of(component));
    without.push_back({{"cause", one.cause}, {"components", std::move(components)}});
  }
  return Json{{"components", curves},
              {"squareness_um_per_m", squareness},
              {"left_out", std::move(without)},
              {"measurement_lines_mm", lines},
              {"rotary", true_rotary_components(*workshop.simulation, angles)}};
}

Answer power(const Workshop& workshop, Arguments& arguments) {
  const std::string state = arguments.word("state");
  if (workshop.unit == nullptr) arguments.complain("this machine has no unit");
  if (state != "on" && state != "off" && state != "cycle")
    arguments.complain("state: expected on, off or cycle, got \"{}\"", state);
  ECS_DO(arguments.checked());
  if (state != "on") workshop.unit->power(false);
  if (state == "cycle") workshop.simulation->come_to_rest();
  if (state != "off" && !(state == "on" && workshop.unit->powered())) workshop.unit->power(true);
  if (state != "off" && !workshop.unit->powered())
    return problem(ProblemKind::output,
                   "the unit does not start, because the file of its battery memory cannot be written: "
                   "make room on the disk, then switch the unit on again");
  workshop.simulation->idle_tick();
  return state_of(workshop);
}

Answer wait(const Workshop& workshop, Arguments& arguments) {
  const double seconds = arguments.number_or("seconds", 0.0);
  if (!(seconds >= 0.0 && seconds <= 86'400.0 * 30)) arguments.complain("seconds: expected 0 to 2592000");
  ECS_DO(arguments.checked());
  if (!workshop.simulation->dwell(seconds)) return simulation_stopped_early();
  return state_of(workshop);
}

Answer tick(const Workshop& workshop, Arguments& arguments) {
  const auto count = arguments.integer("count", 0, 100'000'000).value_or(1);
  ECS_DO(arguments.checked());
  const double seconds = static_cast<double>(count) * workshop.simulation->period_s();
  if (!workshop.simulation->run_for(seconds)) return simulation_stopped_early();
  return state_of(workshop);
}

Answer load(const Workshop& workshop, Arguments& arguments) {
  const double load_kg = arguments.number("kg").value_or(-1.0);
  if (!(load_kg >= 0.0 && load_kg <= 1e6)) arguments.complain("kg: expected 0 to 1000000");
  ECS_DO(arguments.checked());
  workshop.simulation->machine().load(load_kg);
  return state_of(workshop);
}

Answer change_tool(const Workshop& workshop, Arguments& arguments) {
  const auto number = arguments.integer("number", 0, kGreatestToolNumber);
  ECS_DO(arguments.checked());
  const auto tool = static_cast<std::uint16_t>(number.value_or(0));
  if (!workshop.simulation->has_tool(tool))
    return wrong(fmt::format("number: the magazine has no tool {}; see [[emulator.tool]] of the machine file", tool));
  workshop.simulation->change_tool(tool);
  return state_of(workshop);
}

/// "Power on" of the control.
Answer switch_control(const Workshop& workshop, Arguments& arguments) {
  const std::string state = arguments.word("state");
  if (state != "on" && state != "off") arguments.complain("state: expected on or off, got \"{}\"", state);
  ECS_DO(arguments.checked());
  workshop.simulation->switch_control(state == "on");
  workshop.simulation->come_to_rest();
  return state_of(workshop);
}

/// The tool against the workpiece as the machine stands, systematic part only.
Answer tool_error(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(arguments.checked());
  Simulation& simulation = *workshop.simulation;
  return Json{{"error_um", by_axis(simulation.machine(), simulation.tool_now(false).error_um)},
              {"time_s", simulation.machine().time_s()}};
}

Answer fault(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(provoke(workshop, arguments));
  return state_of(workshop);
}

/// What stands on the front of the unit.
Answer arm_code(const Workshop& workshop, Arguments& arguments) {
  if (workshop.unit == nullptr) arguments.complain("this machine has no unit");
  ECS_DO(arguments.checked());
  return Json{{"arm_code", workshop.unit->shown_code()}};
}

template <Answer (*kAct)(const Workshop&, Arguments&)>
Answer at_once(const Workshop& workshop, Arguments& arguments, const Report& /*report*/) {
  return kAct(workshop, arguments);
}

struct NamedAction {
  std::string_view name;
  Answer (*act)(const Workshop&, Arguments&, const Report&);
  bool moves = false;  ///< the control must be on
};
constexpr std::array<NamedAction, 23> kActions{{{"state", at_once<show>},
                                                {"jog", at_once<jog>, true},
                                                {"reference", at_once<reference_machine>, true},
                                                {"measure", measure_machine, true},
                                                {"plan", follow_plan, true},
                                                {"capture", at_once<capture_machine>},
                                                {"run", run_part_program, true},
                                                {"mdi", at_once<run_block>, true},
                                                {"circle", at_once<read_circle>, true},
                                                {"lengths", at_once<read_lengths>, true},
                                                {"ball", at_once<read_ball>, true},
                                                {"turn", at_once<read_turn>, true},
                                                {"survey", at_once<survey_machine>},
                                                {"components", at_once<true_components>},
                                                {"tool", at_once<tool_error>},
                                                {"power", at_once<power>},
                                                {"wait", at_once<wait>},
                                                {"tick", at_once<tick>},
                                                {"load", at_once<load>},
                                                {"change-tool", at_once<change_tool>},
                                                {"control", at_once<switch_control>},
                                                {"fault", at_once<fault>},
                                                {"arm-code", at_once<arm_code>}}};

Answer act(const Workshop& workshop, const Json& request, const Report& report) {
  if (!request.is_object() || !request.contains("action") || !request["action"].is_string())
    return wrong("expected an object with an \"action\"");
  const auto name = request["action"].get<std::string>();
  Arguments arguments(request);
  workshop.simulation->come_to_rest();
  std::string names;
  for (const NamedAction& action : kActions) {
    if (action.name == name && action.moves && !workshop.simulation->control_on())
      return problem(ProblemKind::refused, "the control is off: switch it on first (control on), then reference");
    if (action.name == name) return action.act(workshop, arguments, report);
    names += fmt::format("{}{}", names.empty() ? "" : &action == &kActions.back() ? " or " : ", ", action.name);
  }
  return wrong(fmt::format("action: expected {}, got \"{}\"", names, name));
}

}  // namespace

std::string perform(const Workshop& workshop, const std::string& request, const Report& report) {
  const Json parsed = Json::parse(request, nullptr, false);
  const Answer answer =
      parsed.is_discarded() ? Answer(wrong("expected one JSON object on one line")) : act(workshop, parsed, report);
  if (!answer) {
    const Json failure{
        {"ok", false}, {"exit", exit_code_of(answer.error().kind)}, {"error", {{"message", to_text(answer.error())}}}};
    return failure.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  Json line = *answer;
  line["ok"] = true;
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace ecs::emulator
