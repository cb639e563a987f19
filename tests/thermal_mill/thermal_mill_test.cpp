// A machine that warms, bends and is loaded for a day: the error at the tool with the map's geometry alone, and with
// its thermal rows, which may follow a sensor late.
#include <random>

#include "base/file.hpp"
#include "base/random.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/effects/definition.hpp"
#include "tests/thermal_mill/mill.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

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
  CHECK(late.effects.back().fitted.at("lag_s") == Approx(2400.0).epsilon(0.1));
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
