// From a model to the machine: what `map build --from-model` compiles, in the emulated unit, on a machine that warms,
// bends and is loaded. The error at the tool with the map's geometry alone, and with its thermal rows.
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "base/file.hpp"
#include "base/random.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "laser/map/image.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/compiled_model.hpp"
#include "model/fit/model_file.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

using protocol::Command;
using protocol::CommandCode;
using protocol::CommandState;

/// The image for this machine: what the model lacks is declared zero. @param thermal  false: without its rows
std::vector<std::uint8_t> image_from(const std::string& model_text, const params::Machine& machine,
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
  const ComponentSet needed = components_needed(parameters);
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto c = static_cast<Component>(i);
    const bool has = is_squareness(c) ? squareness_um_per_m(parameters, c) != 0.0
                                      : laser::table_of(made.map, c, Approach::forward) != nullptr;
    if (needed.contains(c) && !has) header.declared_zero.push_back({c, "exact in this test"});
  }
  if (!thermal) header.thermal.clear();
  return must(laser::image_of(made.map, parameters)).bytes;
}

/// Machine and unit, compensating with that image.
struct Mill {
  Simulation simulation;
  Unit unit;

  Mill(const WorkshopMachine& machine, TrueErrors errors, const std::string& model_text, bool thermal)
      : simulation(machine, std::move(errors), machine.settings.seed),
        unit({machine.settings.serial_number, 1,
              AxisModules{Transducer::encoder, Transducer::encoder, Transducer::encoder}, LinkSense::integrate,
              machine.machine.inputs}) {
    simulation.attach(&unit);
    unit.power(true);
    simulation.tick();
    const auto image = image_from(model_text, machine.machine, machine.settings.serial_number, thermal);
    const auto staged = unit.begin({.code = CommandCode::begin_staging});
    REQUIRE(unit.write_memory(staged.value, image) == protocol::UnitError::none);
    const auto committed = unit.begin({.code = CommandCode::commit_staged,
                                       .length = static_cast<std::uint32_t>(image.size()),
                                       .digest = protocol::short_digest(protocol::digest_of(image))});
    REQUIRE_MESSAGE(committed.state == CommandState::done, committed.text);
    load(0.0);
    (void)unit.begin({.code = CommandCode::enter_compensation});
    simulation.tick();
    REQUIRE(reference(simulation, {Axis::X, Axis::Y, Axis::Z}).has_value());
    REQUIRE(unit.mode() == UnitMode::compensating);
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

/// Rms over the times of a course, with the map's geometry alone and with its thermal rows.
struct BeforeAfter {
  double geometry_um = 0.0;
  double thermal_um = 0.0;
};
BeforeAfter before_after(const std::function<std::unique_ptr<Mill>(bool thermal)>& made,
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

/// One cause in the machine and in the model.
struct Alone {
  const char* effect;
  const char* errors;
  const char* model;
};
constexpr std::array<Alone, 5> kAlone{{
    {"thermal_scale", "axis = \"X\"\nparameters = { um_per_m_degC = 11.5 }",
     "axis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m_degC = 11.5 }"},
    {"thermal_drift", "axis = \"Z\"\nsense = \"EZ\"\nsensor = \"spindle\"\nparameters = { um_per_degC = -2.4 }",
     "sense = \"EZ\"\nsensor = \"t_spindle_degC\"\nparameters = { um_per_degC = -2.4 }"},
    {"thermal_bend",
     "axis = \"X\"\nsense = \"EZ\"\nsensor = \"material\"\nsensor2 = \"front\"\nparameters = { um_per_m2_degC = 20.0 }",
     "axis = \"X\"\nsense = \"EZ\"\nsensor = \"t_material_degC\"\nsensor2 = \"t_front_degC\"\n"
     "parameters = { um_per_m2_degC = 20.0 }"},
    {"warm_up", "axis = \"X\"\nsense = \"EX\"\nparameters = { tau_s = 240.0, c_um = 8.0, c_um_per_m = 15.0 }",
     "axis = \"X\"\nsense = \"EX\"\nparameters = { tau_s = 240.0, c_um = 8.0, c_um_per_m = 15.0 }"},
    {"load", "axis = \"Y\"\nsense = \"EZ\"\nparameters = { um_per_kg = -0.01, um_per_kg_m = 0.02 }",
     "axis = \"Y\"\nsense = \"EZ\"\nparameters = { um_per_kg = -0.01, um_per_kg_m = 0.02 }"},
}};

/// A machine with inputs for all of it.
WorkshopMachine machine_with_inputs() {
  return machine_of(ideal_machine() +
                    "[inputs]\nt_material_degC = 1\nt_front_degC = 2\nt_spindle_degC = 3\n"
                    "load_kg = true\nmotion_X_mm_min = 1500.0\n");
}

std::string table_of_effect(const char* id, const char* keys) {
  return std::string("[[effect]]\nid = \"") + id + "\"\n" + keys + "\n";
}

}  // namespace

TEST_CASE("every effect with live inputs, alone in a machine, falls to a quarter and less by its thermal rows") {
  std::size_t carried = 0;
  for (const model::EffectDefinition& effect : model::effect_library())
    carried += effect.carrier == model::Carrier::inputs ? 1 : 0;
  CHECK(carried == kAlone.size());
  for (const Alone& alone : kAlone) {
    const std::string name = alone.effect;
    CAPTURE(name);
    REQUIRE(model::effect_named(alone.effect)->carrier == model::Carrier::inputs);
    const std::string errors = kWarmWorkshop + table_of_effect(alone.effect, alone.errors);
    const auto made = [&](bool thermal) {
      Simulation cold(machine_with_inputs(), errors_of(errors), 1);
      const std::string origin =
          "[origin]\ntemperatures = { t_spindle_degC = " + std::to_string(cold.heat().first_degC_at(2)) + " }\n";
      return std::make_unique<Mill>(machine_with_inputs(), errors_of(errors),
                                    table_of_effect(alone.effect, alone.model) + origin, thermal);
    };
    const bool warms_by_motion = std::string_view(alone.effect) == "warm_up";
    const auto course = [&](Mill& mill, int step) {
      mill.load(step < 3 ? 0.0 : 400.0);
      if (!warms_by_motion) REQUIRE(mill.simulation.dwell(1200.0));
      for (int pass = 0; warms_by_motion && pass < 8; ++pass) {
        REQUIRE(mill.simulation.move_to({-450.0, -200.0, -150.0}, 3000.0));
        REQUIRE(mill.simulation.move_to({-50.0, -200.0, -150.0}, 3000.0));
      }
    };
    const BeforeAfter rms = before_after(made, course, 8);
    MESSAGE(name << ": " << rms.geometry_um << " um, with thermal rows " << rms.thermal_um << " um");
    CHECK(rms.geometry_um > 1.0);
    CHECK(rms.thermal_um <= 0.25 * rms.geometry_um);
  }
}

TEST_CASE(
    "every effect that tables of the map or the parameters carry, alone in a machine, falls to a tenth and less") {
  constexpr const char* kCurveInMachine = "points = [[-500, -6.0], [-300, 4.0], [-200, 5.0], [0, -3.0]]";
  constexpr const char* kCurveInModel =
      "curve = { p_mm = [-500.0, -300.0, -200.0, 0.0], value = [-6.0, 4.0, 5.0, -3.0] }";
  const std::string along = "axis = \"X\"\nsense = \"EX\"\n", bent = "axis = \"X\"\ncode = \"ECX\"\n";
  const auto both = [&](const std::string& keys) { return std::pair(along + keys, along + keys); };
  const std::map<std::string, std::pair<std::string, std::string>> alone{
      {"offset", both("parameters = { um = 7.0 }")},
      {"scale", both("parameters = { um_per_m = -32.0 }")},
      {"cyclic", both("parameters = { period_mm = 130.0, amplitude_um = 6.0, phase_rad = 0.7 }")},
      {"backlash", both("parameters = { um = 9.0 }")},
      {"step", both("parameters = { height_um = 11.0, position_mm = -170.0 }")},
      {"sag", both("parameters = { k2 = 60.0, k3 = -20.0 }")},
      {"progressive", {along + kCurveInMachine, along + kCurveInModel}},
      {"reversal_curve", {along + kCurveInMachine, along + kCurveInModel}},
      {"angular", {bent + kCurveInMachine, bent + kCurveInModel}},
      {"squareness",
       {"code = \"C0Y\"\nparameters = { um_per_m = 25.0 }", "code = \"C0Y\"\nparameters = { um_per_m = 25.0 }"}},
  };
  for (const model::EffectDefinition& effect : model::effect_library()) {
    const bool tables = effect.carrier == model::Carrier::error_map;
    // What else the parameters correct is no error of the machine: a fault of the map in the unit, or of its line.
    if (!tables && effect.id != "squareness") continue;
    const std::string id(effect.id);
    CAPTURE(id);
    REQUIRE(alone.contains(id));
    const auto& [in_machine, in_model] = alone.at(id);
    const auto rms_um = [&](const std::string& model_text) {
      Mill mill(machine_with_inputs(), errors_of(table_of_effect(id.c_str(), in_machine.c_str())), model_text, true);
      return std::sqrt(mill.square_um2());
    };
    const double before = rms_um(""), after = rms_um(table_of_effect(id.c_str(), in_model.c_str()));
    MESSAGE(id << ": " << before << " um, with the map " << after << " um");
    CHECK(before > 0.5);
    CHECK(after <= 0.1 * before);
  }
}

TEST_CASE("a day of the thermal mill: its model's rows leave a quarter and less of what geometry alone leaves") {
  const std::string folder = "samples/thermal_mill/";
  const WorkshopMachine machine = must(load_workshop_machine(folder + "machine.toml"));
  const std::string model = must(read_file(folder + "model.toml"));
  const auto made = [&](bool thermal) {
    return std::make_unique<Mill>(machine, must(TrueErrors::load(folder + "errors.toml")), model, thermal);
  };
  const auto course = [](Mill& mill, int hour) {
    if (hour == 4) mill.load(600.0);
    if (hour > 0) REQUIRE(mill.simulation.dwell(3600.0));
  };
  const BeforeAfter rms = before_after(made, course, 10);
  MESSAGE("a day of ten hours: geometry alone " << rms.geometry_um << " um, with thermal rows " << rms.thermal_um
                                                << " um");
  CHECK(rms.geometry_um > 5.0);
  CHECK(rms.thermal_um <= 0.25 * rms.geometry_um);
}

namespace {

/// X grows with the bed, which follows the air with 40 minutes; the sensor hangs in the air. The bed has the
/// temperature of the air when the machine is switched on.
std::string bed_behind_air() {
  const std::string text = R"(
[air]
mean_degC = 21.0
swing_degC = 4.0
wander_degC = 1.5
[sensor.material]
of = "air"
lag_s = 20.0
noise_degC = 0.02
[[effect]]
id = "thermal_scale"
axis = "X"
parameters = { um_per_m_degC = 11.5 }
[material]
lag_s = 2400.0
)";
  const Simulation cold(machine_with_inputs(), errors_of(text), 1);
  return text + "start_degC = " + std::to_string(cold.heat().first_degC_at(0)) + "\n";
}

/// Runs of X, one every quarter of an hour, read with a noise of 0.2 um beside the sensors of the machine.
laser::MeasurementSet measured_hours(Mill& mill, int runs) {
  constexpr double kQuarter_s = 900.0, kNoise_um = 0.2;
  std::mt19937_64 random(5);
  NormalDraws noise(0.0, kNoise_um);
  laser::MeasurementSet set;
  for (int run = 1; run <= runs; ++run) {
    for (int target = 0; target <= 10; ++target) {
      const double x_mm = -50.0 * target;
      REQUIRE(mill.simulation.move_to({x_mm, -200.0, -150.0}, 0.0));
      REQUIRE(mill.simulation.dwell(5.0));
      laser::Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                       .axis = Axis::X,
                       .position_mm = {x_mm, -200.0, -150.0},
                       .sense = Sense::EX};
      r.approach = Approach::reverse;
      r.run = run;
      r.time_s = mill.simulation.machine().time_s();
      for (const auto& [name, degC] : mill.simulation.sensors_degC(*r.time_s))
        r.sensors_degC["t_" + name + "_degC"] = degC;
      r.error = mill.simulation.tool_now(false).error_um[0] + noise(random);
      set.readings.push_back(r);
    }
    REQUIRE(mill.simulation.dwell(kQuarter_s));
  }
  return set;
}

}  // namespace

TEST_CASE("a bed that follows a sensor late is found from readings, built into the map and compensated with its lag") {
  const std::string errors = bed_behind_air();
  Mill measured(machine_with_inputs(), errors_of(errors), "", false);
  const laser::MeasurementSet set = measured_hours(measured, 24);
  model::Model start;
  for (const char* id : {"offset", "scale"})
    start.effects.push_back({.id = model::effect_named(id), .axis = Axis::X, .sense = Sense::EX});
  const params::Machine machine = machine_with_inputs().machine;
  const model::Observations data = model::observations_of(set, start, machine);

  const model::Diagnosis found = must(model::diagnose(start, data));
  REQUIRE_FALSE(found.candidates.empty());
  const model::Candidate& first = found.candidates.front();
  CHECK(to_text(first.effect) == "thermal_scale:X:EX");
  MESSAGE(found.headline);
  CHECK(contains(found.headline, "following it with a time constant of"));

  const model::Model late = must(model::add_effect(start, data, model::request_of(first.effect), "x.csv")).model;
  CHECK(late.effects.back().parameters.at("lag_s") == Approx(2400.0).epsilon(0.1));
  model::Model at_once = start;
  at_once.effects.push_back(late.effects.back());
  at_once.effects.back().parameters = {{"lag_s", 0.0}};
  at_once.effects.back().fitted.clear();
  at_once = model::with_values(at_once, must(model::fit(at_once, data)));

  const auto course = [](Mill& mill, int) { REQUIRE(mill.simulation.dwell(2400.0)); };
  const auto rms = [&](const model::Model& one) {
    return before_after(
        [&](bool thermal) {
          return std::make_unique<Mill>(machine_with_inputs(), errors_of(errors), model::to_toml(one), thermal);
        },
        course, 9);
  };
  const BeforeAfter with_lag = rms(late), without_lag = rms(at_once);
  MESSAGE("six hours: geometry alone " << with_lag.geometry_um << " um, rows at once " << without_lag.thermal_um
                                       << " um, rows with their lag " << with_lag.thermal_um << " um");
  CHECK(with_lag.thermal_um < 0.25 * with_lag.geometry_um);
  CHECK(with_lag.thermal_um < 0.5 * without_lag.thermal_um);
}

TEST_CASE("an effect without its input is left out of the map with the reason") {
  const auto reason = [](const std::string& inputs, const std::string& effect) {
    const auto machine = machine_of(ideal_machine() + inputs).machine;
    const auto made = must(model::compiled(must(model::parse_model(effect, "model.toml", ".")), machine, 50.0));
    CHECK(made.map.header.thermal.empty());
    REQUIRE(made.not_carried.size() == 1);
    return made.not_carried.front();
  };
  for (const Alone& alone : kAlone) {
    const std::string why = reason("", table_of_effect(alone.effect, alone.model));
    CHECK(contains(why, "[inputs]"));
  }
  CHECK(contains(reason("[inputs]\nt_spindle_degC = 3\n", table_of_effect(kAlone[1].effect, kAlone[1].model)),
                 "the model does not state the temperature of t_spindle_degC at its origin"));
  CHECK(contains(reason("[inputs]\nt_material_degC = 1\n", table_of_effect("thermal_scale",
                                                                           "axis = \"X\"\nsense = \"EB\"\n"
                                                                           "parameters = { um_per_m_degC = 1.0 }")),
                 "no row for a rotation that changes along its axis"));
}
