// An emulated machine with a unit that compensates: the image of a model, the unit at its machine, the error at the
// tool.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ecs_emulator/unit/unit.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "laser/map/image.hpp"
#include "model/fit/compiled_model.hpp"
#include "model/fit/model_file.hpp"
#include "tests/support/workshop_machines.hpp"

namespace ecs::emulator::test {

using protocol::Command;
using protocol::CommandCode;
using protocol::CommandState;

/// What the parameters need and the map lacks is declared zero.
inline void declare_rest_zero(laser::ErrorMap& map, const UnitParameters& parameters) {
  auto& zeros = map.header.declared_zero;
  const ComponentSet needed = components_needed(parameters);
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto c = static_cast<Component>(i);
    const bool has = is_squareness(c) ? squareness_um_per_m(parameters, c) != 0.0
                                      : laser::table_of(map, c, Approach::forward) != nullptr;
    const auto is_same = [c](const laser::DeclaredZero& zero) { return zero.component == c; };
    if (needed.contains(c) && !has && std::ranges::none_of(zeros, is_same)) zeros.push_back({c, "exact in this test"});
  }
}

/// The image for this machine: what the model lacks is declared zero. @param thermal  false: without its rows
inline std::vector<std::uint8_t> image_from(const std::string& model_text, const params::Machine& machine,
                                            const std::string& serial_number, bool thermal) {
  const model::Model model = must(model::parse_model(model_text, "model.toml", "."));
  model::CompiledModel made = must(model::compiled(model, machine, 50.0));
  const std::string why = made.not_carried.empty() ? std::string() : made.not_carried.front();
  CAPTURE(why);
  REQUIRE(made.not_carried.empty());
  UnitParameters parameters = params::default_parameters_for(machine);
  for (std::size_t i = kCurves; i < kComponents; ++i)
    squareness_um_per_m(parameters, static_cast<Component>(i)) = made.squareness[i];
  laser::MapHeader& header = made.map.header;
  header.serial_number = serial_number;
  declare_rest_zero(made.map, parameters);
  if (!thermal) header.thermal.clear();
  return must(laser::image_of(made.map, parameters)).bytes;
}

/// Machine and unit, compensating with that image.
struct Mill {
  Simulation simulation;
  Unit unit;

  Mill(const WorkshopMachine& machine, TrueErrors errors, const std::vector<std::uint8_t>& image)
      : simulation(machine, std::move(errors), machine.settings.seed),
        unit({machine.settings.serial_number, 1,
              AxisModules{Transducer::encoder, Transducer::encoder, Transducer::encoder}, LinkSense::integrate,
              machine.machine.inputs}) {
    simulation.attach(&unit);
    unit.power(true);
    simulation.tick();
    commit(image);
    load(0.0);
    (void)unit.begin({.code = CommandCode::enter_compensation});
    simulation.tick();
    REQUIRE(reference(simulation, {Axis::X, Axis::Y, Axis::Z}).has_value());
    REQUIRE(unit.mode() == UnitMode::compensating);
  }
  Mill(const WorkshopMachine& machine, TrueErrors errors, const std::string& model_text, bool thermal)
      : Mill(machine, std::move(errors),
             image_from(model_text, machine.machine, machine.settings.serial_number, thermal)) {}

  void commit(const std::vector<std::uint8_t>& image) {
    const auto staged = unit.begin({.code = CommandCode::begin_staging});
    REQUIRE(unit.write_memory(staged.value, image) == protocol::UnitError::none);
    const auto committed = unit.begin({.code = CommandCode::commit_staged,
                                       .length = static_cast<std::uint32_t>(image.size()),
                                       .digest = protocol::short_digest(protocol::digest_of(image))});
    REQUIRE_MESSAGE(committed.state == CommandState::done, committed.text);
  }

  /// On the table, and stated to the unit.
  void load(double kg) {
    simulation.machine().load(kg);
    REQUIRE(unit.begin({.code = CommandCode::set_input, .input = kLoadInput, .input_value = kg}).state ==
            CommandState::done);
  }

  /// Mean square of the error of the tool at nine places [um^2].
  double square_um2() {
    const auto travel = simulation.machine().travel_mm();
    double sum = 0.0;
    for (const double x : {0.1, 0.5, 0.9})
      for (const double yz : {0.1, 0.5, 0.9}) {
        const auto at = [&](std::size_t a, double part) { return travel[a][0] + part * (travel[a][1] - travel[a][0]); };
        REQUIRE(simulation.move_to({at(0, x), at(1, yz), at(2, yz)}, 0.0));
        for (const double um : simulation.tool_now(false).error_um) sum += um * um;
      }
    return sum / 9.0;
  }
};

/// Distances between tool and workpiece from where they should be [um].
struct ToolErrors {
  double rms_um = 0.0, largest_um = 0.0;
};

/// At 60 places and angles, each with its own approaches; the unit compensates until the end. They lie between 10 and
/// 90 % of the travels of X, Y, Z and over the whole travels of A, B, C.
inline ToolErrors at_turned_tool(Mill& mill, const params::Machine& machine, const Vector3& tool_mm) {
  constexpr int kPlaces = 60;
  constexpr std::array kSteps{0.5698402910, 0.8191725134, 0.6710436067};
  constexpr std::array kTurnSteps{0.6180339887, 0.7548776662, 0.6180339887};
  const auto part = [](int k, double step) { return std::fmod(0.5 + k * step, 1.0); };
  ToolErrors errors;
  for (int k = 0; k < kPlaces; ++k) {
    Vector3 angle_deg{}, place_mm{};
    std::size_t rotary = 0;
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (const auto& axis = machine.rotary[a])
        angle_deg[a] = std::lerp(axis->travel_deg[0], axis->travel_deg[1], part(k, kTurnSteps[rotary++]));
      const auto [low, high] = machine.axes[a]->travel_mm;
      place_mm[a] = std::lerp(low, high, 0.1 + 0.8 * part(k, kSteps[a]));
    }
    mill.simulation.machine().turn_to(angle_deg);
    REQUIRE(mill.simulation.move_to(place_mm, 0.0));
    const TurningPose pose = mill.simulation.turned_tool(tool_mm);
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

/// Rms over the times of a course, with the map's geometry alone and with its thermal rows.
struct BeforeAfter {
  double geometry_um = 0.0;
  double thermal_um = 0.0;
};
inline BeforeAfter before_after(const std::function<std::unique_ptr<Mill>(bool thermal)>& made,
                                const std::function<void(Mill&, int step)>& course, int steps) {
  const auto rms_um = [&](bool thermal) {
    const auto mill = made(thermal);
    double sum = 0.0;
    for (int step = 0; step < steps; ++step) {
      course(*mill, step);
      sum += mill->square_um2();
    }
    CHECK(mill->unit.fault() == Fault::none);
    return std::sqrt(sum / steps);
  };
  return {rms_um(false), rms_um(true)};
}

/// A machine with inputs for all of it.
inline std::string inputs_text() {
  return ideal_machine() +
         "[inputs]\nt_material_degC = 1\nt_front_degC = 2\nt_spindle_degC = 3\n"
         "load_kg = true\nmotion_X_mm_min = 1500.0\n";
}
inline WorkshopMachine machine_with_inputs() { return machine_of(inputs_text()); }

}  // namespace ecs::emulator::test
