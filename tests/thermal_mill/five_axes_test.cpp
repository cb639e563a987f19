// Five axes in the loop: an emulated machine whose rotary axes have location errors, waves and lost motion, a map with
// what `--rotary` makes of these errors, and the unit at it. The error of the tool against the workpiece comes from the
// emulator's exact matrices, which share no code with the core.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/rotary_part.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/regression/candidates.hpp"
#include "tests/support/folder.hpp"
#include "tests/thermal_mill/mill.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// A machine of three linear axes and two rotary ones.
struct FiveAxes {
  std::string configuration;
  std::array<char, 2> rotary{'A', 'C'};
  std::array<const char*, 2> facts{};  ///< lines of the tables of the rotary axes
  Vector3 tool_mm{};
};

const FiveAxes kTiltingTable{"XYACTZ",
                             {'A', 'C'},
                             {"travel_deg = [-110.0, 30.0]\npivot_mm = [300.0, 250.0, -360.0]\n",
                              "travel_deg = [0.0, 360.0]\npivot_mm = [300.0, 250.0, -360.0]\n"},
                             {}};
const FiveAxes kForkHead{"XYTZCB",
                         {'B', 'C'},
                         {"travel_deg = [-100.0, 100.0]\npivot_mm = [0.0, 0.0, 150.0]\n",
                          "travel_deg = [-180.0, 180.0]\npivot_mm = [0.0, 0.0, 150.0]\n"},
                         {0.0, 0.0, -120.0}};
const FiveAxes kHeadAndTable{"XYCTZB",
                             {'B', 'C'},
                             {"travel_deg = [-30.0, 120.0]\npivot_mm = [5.0, 0.0, 150.0]\n",
                              "travel_deg = [0.0, 360.0]\npivot_mm = [300.0, 250.0, -380.0]\n"},
                             {10.0, 0.0, -120.0}};

std::string machine_text(const FiveAxes& chain) {
  std::string text = fmt::format(
      "name = \"five axes\"\nconfiguration = \"{}\"\n[axis.X]\ntravel_mm = [0.0, 600.0]\n[axis.Y]\n"
      "travel_mm = [0.0, 500.0]\n[axis.Z]\ntravel_mm = [-400.0, 0.0]\n",
      chain.configuration);
  for (std::size_t i = 0; i < 2; ++i)
    text += fmt::format("[axis.{}]\n{}resolution_deg = {}\ntransducer_zero_deg = 17.0\n", chain.rotary[i],
                        chain.facts[i], i == 0 ? "0.0001" : "-0.0002");
  for (const char axis : {'X', 'Y', 'Z'}) text += fmt::format("[emulator.axis.{}]\ndrive = \"ideal\"\n", axis);
  return text;
}

/// A wave with lost motion: amplitude cos(n angle + phase) + half of the lost motion by approach.
struct Wave {
  std::size_t axis = 0;
  Sense sense = Sense::EX;
  double amplitude = 0.0, waves = 1.0, phase = 0.0, lost = 0.0;
};
const std::array kWaves{Wave{0, Sense::EX, 3.0, 1.0, 0.3, 0.0},   Wave{0, Sense::EY, -2.0, 2.0, 0.0, 1.5},
                        Wave{0, Sense::EB, 12.0, 1.0, 1.0, 0.0},  Wave{1, Sense::EZ, 2.5, 1.0, 0.6, 0.0},
                        Wave{1, Sense::EA, -10.0, 2.0, 0.2, 0.0}, Wave{1, Sense::EC, 20.0, 1.0, -0.5, 12.0}};
/// XO. YO. ZO. AO. BO. CO. of both.
constexpr std::array<std::array<double, 6>, 2> kLocation{
    {{6.0, -8.0, 5.0, 15.0, -12.0, 9.0}, {-7.0, 9.0, 0.0, -18.0, 11.0, 0.0}}};

std::string errors_text(const FiveAxes& chain) {
  std::string text = "[location]\n";
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t s = 0; s < 6; ++s)
      if (kLocation[i][s] != 0.0) text += fmt::format("{}O{} = {}\n", "XYZABC"[s], chain.rotary[i], kLocation[i][s]);
  for (const Wave& wave : kWaves)
    text += fmt::format("[[contribution]]\ncomponent = \"{}{}\"\nformula = \"{}*cos({}*p*pi/180+({}))+{}*d\"\n",
                        name_of(wave.sense), chain.rotary[wave.axis], wave.amplitude, wave.waves, wave.phase,
                        wave.lost / 2.0);
  return text + "[[effect]]\nid = \"scale\"\naxis = \"X\"\nparameters = { um_per_m = -32.0 }\n";
}

/// As they are measured every 5 deg.
volume::RotaryErrors measured_errors(const FiveAxes& chain) {
  volume::RotaryErrors errors;
  for (std::size_t i = 0; i < 2; ++i) errors.location[static_cast<std::size_t>(chain.rotary[i] - 'A')] = kLocation[i];
  for (const Wave& wave : kWaves)
    for (const Approach approach : {Approach::reverse, Approach::forward}) {
      auto& table = errors.tables.emplace_back();
      table.joint = *kinematics::joint_of(chain.rotary[wave.axis]);
      table.sense = wave.sense;
      table.approach = approach;
      for (int k = -36; k < 36; ++k) {
        const double side = approach == Approach::forward ? 0.5 : -0.5;
        table.p_deg.push_back(5.0 * k);
        table.error.push_back(wave.amplitude * std::cos(wave.waves * 5.0 * k * std::numbers::pi / 180.0 + wave.phase) +
                              side * wave.lost);
      }
    }
  return errors;
}

std::vector<std::uint8_t> image_with(const FiveAxes& chain, const WorkshopMachine& machine, bool rotary) {
  const model::Model model = must(model::parse_model(
      "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m = -32.0 }\n", "model.toml",
      "."));
  laser::ErrorMap map = must(model::compiled(model, machine.machine, 50.0)).map;
  map.header.serial_number = machine.settings.serial_number;
  UnitParameters parameters = params::default_parameters_for(machine.machine);
  parameters.tool_offset_mm = chain.tool_mm;
  parameters.tool_range_mm = {50.0, 50.0, 200.0};
  declare_rest_zero(map, parameters);
  std::vector<std::string> notes;
  if (rotary) {
    const auto with_rotary = must(params::parse_rotary_machine(machine_text(chain), "machine.toml"));
    map.header.rotary = must(commissioning::rotary_part_of(measured_errors(chain), with_rotary, notes));
    map.header.rotary_configuration = chain.configuration;
  }
  CHECK(notes.empty());
  return must(laser::image_of(map, parameters)).bytes;
}

ToolErrors at_the_tool(const FiveAxes& chain, bool rotary) {
  const WorkshopMachine machine = machine_of(machine_text(chain));
  Mill mill(machine, errors_of(errors_text(chain)), image_with(chain, machine, rotary));
  return at_turned_tool(mill, machine.machine, chain.tool_mm);
}

void check_compensated(const FiveAxes& chain) {
  const ToolErrors before = at_the_tool(chain, false), after = at_the_tool(chain, true);
  CAPTURE(after.rms_um);
  CAPTURE(after.largest_um);
  CHECK(before.rms_um > 10.0);
  CHECK(after.rms_um <= 0.01 * before.rms_um);
  CHECK(after.largest_um <= 0.02 * before.largest_um);
}

// From the readings of a ball to the machine: the model begins without errors of the machine but those of its set-up,
// the diagnosis finds the rest, and the map of the model compensates it.

/// Sets of a ball in two places, at angles of both axes, with the noise of a probe.
laser::MeasurementSet ball_sets(const FiveAxes& chain, const std::string& errors,
                                const std::vector<Vector3>& balls_mm) {
  Simulation simulation(machine_of(machine_text(chain)), errors_of(errors), 1);
  laser::MeasurementSet set;
  for (const Vector3& ball_mm : balls_mm) {
    BallPlan plan{.ball_mm = ball_mm, .tool_offset_mm = chain.tool_mm, .off_um = {12.0, -7.0, 9.0}, .noise_um = 0.2};
    const auto one = must(ball_readings(simulation, plan));
    set.readings.insert(set.readings.end(), one.readings.begin(), one.readings.end());
  }
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  return set;
}

struct FoundModel {
  model::Model model;
  std::vector<std::string> named;  ///< by the diagnosis
  model::WhatIf what;
};

/// As `ecs model new`, `diagnose`, `add` and `fit` one after the other; what is proved is added.
FoundModel found_from(const laser::MeasurementSet& set, const params::Machine& machine) {
  FoundModel found;
  const auto data = [&] { return model::observations_of(set, found.model, machine); };
  found.model.effects = model::usual_effects(data());
  for (;;) {
    const auto diagnosis = must(model::diagnose(found.model, data()));
    const auto proved = std::ranges::find_if(diagnosis.candidates, &model::Candidate::named);
    if (proved == diagnosis.candidates.end()) break;
    const auto added = must(model::add_effect(found.model, data(), model::request_of(proved->effect), "ball.csv"));
    found.named.push_back(to_text(added.effect.effect));
    found.model = added.model;
  }
  found.what = must(model::what_if(found.model, data()));
  found.model = model::with_values(found.model, must(model::fit(found.model, data())));
  return found;
}

commissioning::MapFromModel map_of(const FiveAxes& chain, const model::Model& model) {
  const Folder folder;
  commissioning::NoMessages messages;
  auto built = must(planned_map_from_model(messages, {.model = folder.with("model.toml", to_toml(model)),
                                                      .machine = folder.with("machine.toml", machine_text(chain)),
                                                      .zero_missing = "exact in this test"}));
  built.compiled.map.header.serial_number = EmulatorSettings{}.serial_number;
  built.parameters.parameters.tool_offset_mm = chain.tool_mm;
  built.parameters.parameters.tool_range_mm = {50.0, 50.0, 200.0};
  declare_rest_zero(built.compiled.map, built.parameters.parameters);  // what only a tool levers is needed as well
  return built;
}

}  // namespace

TEST_CASE("a tilting rotary table: the unit compensates location errors, waves and lost motion of both axes") {
  check_compensated(kTiltingTable);
}

TEST_CASE("a fork head: the unit compensates the errors of both axes at a tool that they turn") {
  check_compensated(kForkHead);
}

TEST_CASE("a swivelling head and a rotary table: the unit compensates the errors of both axes") {
  check_compensated(kHeadAndTable);
}

TEST_CASE("errors of a tilting table found with a ball reach the machine in the map of the model") {
  const std::string of_rotary_axes =
      "[location]\nXOC = 9.0\nYOC = -7.0\nAOC = 18.0\nBOC = -12.0\nYOA = 6.0\nZOA = -8.0\nBOA = 15.0\nCOA = -9.0\n"
      "[[effect]]\nid = \"cyclic\"\naxis = \"C\"\n"
      "parameters = { period_deg = 360.0, amplitude_um = 20.0, phase_rad = 0.4 }\n"
      "[[effect]]\nid = \"backlash\"\naxis = \"A\"\nparameters = { um = 14.0 }\n";
  const WorkshopMachine machine = machine_of(machine_text(kTiltingTable));
  FoundModel found = found_from(
      ball_sets(kTiltingTable, of_rotary_axes, {{420.0, 250.0, -300.0}, {300.0, 330.0, -250.0}}), machine.machine);
  CHECK(only(found.named) == "cyclic:C:EC");
  for (const model::WhatIf::Share& share : found.what.shares)
    CHECK(share.carried == !share.effect.starts_with("ball_on_table"));
  // X has been measured with a laser
  const std::string scale = "[[effect]]\nid = \"scale\"\naxis = \"X\"\nparameters = { um_per_m = -32.0 }\n";
  found.model.effects.push_back(must(model::parse_model(scale + "sense = \"EX\"\n", "x.toml", ".")).effects.front());
  const commissioning::MapFromModel built = map_of(kTiltingTable, found.model);
  CHECK(built.compiled.not_carried.size() == 2);  // the positions of the ball
  const auto tool_with = [&](const std::vector<std::uint8_t>& image) {
    Mill mill(machine, errors_of(of_rotary_axes + scale), image);
    return at_turned_tool(mill, machine.machine, kTiltingTable.tool_mm);
  };
  const ToolErrors before = tool_with(image_from("", machine.machine, machine.settings.serial_number, true));
  const ToolErrors after = tool_with(must(laser::image_of(built.compiled.map, built.parameters.parameters)).bytes);
  MESSAGE("rms ", before.rms_um, ", largest ", before.largest_um, " um; with the map of the model ", after.rms_um,
          " and ", after.largest_um, " um");
  CHECK(before.rms_um > 10.0);
  CHECK(after.rms_um <= 0.1 * before.rms_um);
  CHECK(after.largest_um <= 0.1 * before.largest_um);
}

namespace {

const char* const kHeadModel = R"(
[[effect]]
id = "location"
code = "XOB"
parameters = { um = 5.0 }
[[effect]]
id = "head_bending"
parameters = { x_sin_um = 20.0, z_cos_um = 3.0 }
[[effect]]
id = "tilt_scale"
axis = "B"
sense = "EB"
parameters = { um_per_degree = 0.5 }
[[effect]]
id = "cyclic"
axis = "C"
sense = "EC"
parameters = { period_deg = 90.0, amplitude_um = 4.0, phase_rad = 0.0 }
[[effect]]
id = "tool_bending"
parameters = { x_sin_um_per_m = 100.0 }
[[effect]]
id = "offset"
axis = "B"
sense = "EX"
parameters = { um = 2.0 }
)";

model::Model head_model() { return must(model::parse_model(kHeadModel, "model.toml", ".")); }

}  // namespace

TEST_CASE("effects of rotary axes become location errors and curves of the map, and what has no place the reason") {
  const commissioning::MapFromModel built = map_of(kForkHead, head_model());
  const auto& axes = built.compiled.map.header.rotary;
  REQUIRE(axes.size() == 2);  // as in the configuration: C, then B
  const laser::MapRotaryAxis &c = axes[0], &b = axes[1];
  CHECK(b.axis.letter == 'B');
  CHECK(b.axis.location[0] == 5.0);
  CHECK(b.start_deg == -100.0);
  CHECK(b.increment_deg == 5.0);
  REQUIRE(b.compensation[1][0].size() == 41);
  CHECK(b.compensation[1][0][38] == Approx(-20.0));  // EXB at 90 deg
  CHECK(b.compensation[0][2][38] == Approx(-3.0));   // EZB
  CHECK(b.compensation[1][4][38] == Approx(-45.0));  // EBB
  CHECK(c.axis.location == std::array<double, 6>{});
  CHECK(c.increment_deg == 2.5);  // 32 values in a period
  CHECK(c.start_deg == -180.0);
  REQUIRE(c.compensation[1][5].size() == 144);
  CHECK(c.compensation[0][5][72 + 9] == Approx(-4.0));  // ECC at 22.5 deg
  CHECK(built.compiled.rotary.at('B') ==
        std::vector<std::string>{"location:B:XOB", "head_bending", "tilt_scale:B:EB", "tool_bending"});
  CHECK(built.compiled.map.header.bending == RotaryBending{{}, {100.0}});
  CHECK(contains(only(built.compiled.not_carried), "offset:B:EX: a constant in readings of a rotary axis is the zero"));
  const auto on_table =
      must(model::parse_model("[[effect]]\nid = \"machine_bending\"\nparameters = { x_sin_um = 9.0 }\n"
                              "[[effect]]\nid = \"location\"\ncode = \"YOA\"\nparameters = { um = 5.0 }\n",
                              "model.toml", "."));
  CHECK(contains(only(map_of(kTiltingTable, on_table).compiled.not_carried),
                 "machine_bending: no rotary axis carries the tool"));
  check_holds(from_model_cell(built, {}).text, {"B from location:B:XOB + head_bending + tilt_scale:B:EB + tool_bending",
                                                "bending of the head: tool_bending x_sin 100.00 um/m"});
}

TEST_CASE("without an input for an angle a map from a model compensates no rotary axis, and says why") {
  const std::string text = machine_text(kForkHead);
  const std::size_t at = text.rfind("resolution_deg");
  const auto machine = machine_of(text.substr(0, at) + text.substr(text.find('\n', at) + 1)).machine;
  const model::CompiledModel made = must(model::compiled(head_model(), machine, 50.0));
  CHECK(made.map.header.rotary.empty());
  CHECK(made.not_carried.size() == 6);
  CHECK(contains(made.not_carried[0], "location:B:XOB: the machine file states no resolution_deg of the axis C"));
}

TEST_CASE("a file of the errors of rotary axes takes the place of those of a model") {
  const Folder folder;
  commissioning::NoMessages messages;
  const auto built = must(planned_map_from_model(
      messages, {.model = folder.with("model.toml", kHeadModel),
                 .machine = folder.with("machine.toml", machine_text(kForkHead)),
                 .rotary = folder.with("rotary.csv", "component,approach,p_deg,error\nYOC,,,3\n"),
                 .zero_missing = "exact in this test"}));
  const auto& axes = built.compiled.map.header.rotary;
  REQUIRE(axes.size() == 2);
  CHECK(axes[0].axis.location[1] == 3.0);
  CHECK(axes[1].axis.location == std::array<double, 6>{});
  CHECK(contains(only(built.notes), "rotary.csv, not from the model: location:B:XOB, head_bending, tilt_scale:B:EB"));
}
