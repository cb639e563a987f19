// Five axes in the loop: an emulated machine whose rotary axes have location errors, waves and lost motion, a map with
// what `--rotary` makes of these errors, and the unit at it. The error of the tool against the workpiece comes from the
// emulator's exact matrices, which share no code with the core.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "commissioning/maps/rotary_part.hpp"
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
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto c = static_cast<Component>(i);
    if (components_needed(parameters).contains(c) && c != Component::EXX)
      map.header.declared_zero.push_back({c, "test"});
  }
  std::vector<std::string> notes;
  if (rotary) {
    const auto with_rotary = must(params::parse_rotary_machine(machine_text(chain), "machine.toml"));
    map.header.rotary = must(commissioning::rotary_part_of(measured_errors(chain), with_rotary, notes));
    map.header.rotary_configuration = chain.configuration;
  }
  CHECK(notes.empty());
  return must(laser::image_of(map, parameters)).bytes;
}

struct ToolErrors {
  double rms_um = 0.0, largest_um = 0.0;
};

/// At 60 places and angles, each with its own approaches.
ToolErrors at_the_tool(const FiveAxes& chain, bool rotary) {
  const WorkshopMachine machine = machine_of(machine_text(chain));
  Mill mill(machine, errors_of(errors_text(chain)), image_with(chain, machine, rotary));
  const auto part = [](int k, double step) { return std::fmod(0.5 + k * step, 1.0); };
  constexpr int kPlaces = 60;
  ToolErrors errors;
  for (int k = 0; k < kPlaces; ++k) {
    Vector3 angle_deg{};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto r = static_cast<std::size_t>(chain.rotary[i] - 'A');
      const auto [low, high] = machine.machine.rotary[r]->travel_deg;
      angle_deg[r] = low + (high - low) * part(k, i == 0 ? 0.6180339887 : 0.7548776662);
    }
    mill.simulation.machine().turn_to(angle_deg);
    REQUIRE(mill.simulation.move_to(
        {600.0 * part(k, 0.5698402910), 500.0 * part(k, 0.8191725134), -400.0 * part(k, 0.6710436067)}, 0.0));
    const TurningPose pose = mill.simulation.turned_tool(chain.tool_mm);
    const double square =
        pose.error_um[0] * pose.error_um[0] + pose.error_um[1] * pose.error_um[1] + pose.error_um[2] * pose.error_um[2];
    errors.rms_um += square / kPlaces;
    errors.largest_um = std::max(errors.largest_um, std::sqrt(square));
  }
  errors.rms_um = std::sqrt(errors.rms_um);
  CHECK(mill.unit.mode() == UnitMode::compensating);
  CHECK(mill.unit.fault() == Fault::none);
  return errors;
}

void check_compensated(const FiveAxes& chain) {
  const ToolErrors before = at_the_tool(chain, false), after = at_the_tool(chain, true);
  CAPTURE(after.rms_um);
  CAPTURE(after.largest_um);
  CHECK(before.rms_um > 10.0);
  CHECK(after.rms_um <= 0.01 * before.rms_um);
  CHECK(after.largest_um <= 0.02 * before.largest_um);
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
