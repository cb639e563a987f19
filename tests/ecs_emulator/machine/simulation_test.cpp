// Machine and unit in one simulated time; heat and sensors in the whole workshop: what is measured, what time does,
// what is refused.
#include "ecs_emulator/machine/simulation.hpp"

#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "ecs_emulator/workshop/workshop.hpp"
#include "laser/writers/writers.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

void go(Simulation& simulation, const Vector3& target_mm) { REQUIRE(simulation.move_to(target_mm, 6000.0)); }

double error_x_um(Simulation& simulation) { return simulation.tool_now(true).error_um[0]; }

constexpr const char* kWarmMachine = R"(
[air]
mean_degC = 21.0
swing_degC = 2.5
wander_degC = 0.3
[material]
lag_s = 5400.0
[screw.X]
fixed_bearing_mm = 0.0
friction_N = 400.0
heat_capacity_J_per_m_degC = 4000.0
[sensor.screw]
of = "screw_X"
at_mm = -100.0
lag_s = 20.0
noise_degC = 0.02
[sensor.far_end]
of = "screw_X"
at_mm = -480.0
[temperature]
oil = "30 + t/100"
)";

std::string measured_csv(Simulation& simulation) {
  MeasurementPlan plan{.targets_mm = {-500.0, -250.0, 0.0}, .runs = 2, .feed_mm_min = 6000.0, .dwell_s = 1.0};
  return laser::to_csv(must(measure(simulation, plan)));
}

}  // namespace

TEST_CASE("the error that does not repeat stays constant while every axis is at rest") {
  auto simulation = simulation_of("[scatter]\nEXX = { reading = 2.0 }\nEXY = { reading = 5.0 }\n");
  go(simulation, {-100.0, -50.0, 0.0});
  const double first_um = error_x_um(simulation);
  CHECK(first_um != 0.0);
  REQUIRE(simulation.dwell(10.0));
  for (int reading = 0; reading < 5; ++reading) CHECK(error_x_um(simulation) == first_um);
}

TEST_CASE("a parked axis adds no scatter between the readings of another one") {
  auto simulation = simulation_of("[scatter]\nEXY = { reading = 5.0 }\n", ideal_machine());
  go(simulation, {0.0, -50.0, 0.0});
  const double parked_um = error_x_um(simulation);
  CHECK(parked_um != 0.0);
  for (const double x_mm : {-100.0, -200.0, -300.0, -100.0}) {
    go(simulation, {x_mm, -50.0, 0.0});
    CHECK(error_x_um(simulation) == Approx(parked_um).epsilon(1e-9));
  }
  go(simulation, {-100.0, -60.0, 0.0});
  CHECK(std::abs(error_x_um(simulation) - parked_um) > 1e-6);
}

TEST_CASE("a repeated stop draws again, with the standard deviation of the errors file") {
  auto simulation = simulation_of("[scatter]\nEXX = { reading = 2.0 }\n", ideal_machine());
  constexpr int kStops = 400;
  double sum_um = 0.0;
  double square_um2 = 0.0;
  double last_um = 0.0;
  for (int stop = 0; stop < kStops; ++stop) {
    go(simulation, {-99.0, 0.0, 0.0});
    go(simulation, {-100.0, 0.0, 0.0});
    const double error_um = error_x_um(simulation);
    CHECK(error_um != last_um);
    last_um = error_um;
    sum_um += error_um;
    square_um2 += error_um * error_um;
  }
  CHECK(std::abs(sum_um / kStops) < 0.3);                              // three times 2 / √400
  CHECK(std::sqrt(square_um2 / kStops) == Approx(2.0).epsilon(0.12));  // three times 2 / √800
}

TEST_CASE("sensors appear in the readings, those of heat and those of formulas") {
  Simulation simulation = simulation_of(kWarmMachine);
  const std::string csv = measured_csv(simulation);
  check_holds(csv, {"t_screw_degC", "t_far_end_degC", "t_oil_degC"});
}

TEST_CASE("travel at one end of the axis warms the screw there") {
  Simulation simulation = simulation_of(kWarmMachine);
  for (int i = 0; i < 40; ++i) {
    REQUIRE(simulation.move_to({-200.0, 0.0, 0.0}, 10'000.0));
    REQUIRE(simulation.move_to({0.0, 0.0, 0.0}, 10'000.0));
  }
  const auto shown = simulation.sensors_degC(simulation.machine().time_s());
  const auto of = [&](const std::string& name) {
    for (const auto& [sensor, degC] : shown)
      if (sensor == name) return degC;
    return 0.0;
  };
  // 80 passes of 400 N over 4000 J/m/degC: 8 degC, less what the sensor lags and the screw loses meanwhile.
  CHECK(of("screw") - of("far_end") > 5.0);
  CHECK(of("screw") - of("far_end") < 8.0);
  const double growth_um = simulation.errors().at(simulation.machine().state(), simulation.heat())[0];
  CHECK(std::abs(growth_um) < 1.0);  // the nut stands at the fixed bearing
}

TEST_CASE("the same seed and the same actions give the same bytes, whatever the real time between them") {
  Simulation one = simulation_of(kWarmMachine);
  Simulation other = simulation_of(kWarmMachine);
  Simulation third = simulation_of(kWarmMachine, small_machine(), 2);
  other.come_to_rest();
  one.come_to_rest();
  for (int i = 0; i < 5000; ++i) other.idle_tick();
  CHECK(measured_csv(one) == measured_csv(other));
  for (int i = 0; i < 5000; ++i) other.idle_tick();
  CHECK(measured_csv(one) == measured_csv(other));
  CHECK(measured_csv(third) != measured_csv(one));
}

TEST_CASE("an hour's wait in one go is an hour's wait in pieces") {
  Simulation one = simulation_of(kWarmMachine);
  Simulation many = simulation_of(kWarmMachine);
  for (Simulation* each : {&one, &many}) REQUIRE(each->move_to({-300.0, 0.0, 0.0}, 10'000.0));
  REQUIRE(one.dwell(3600.0));
  for (int i = 0; i < 60; ++i) REQUIRE(many.dwell(60.0));
  CHECK(one.machine().time_s() == Approx(many.machine().time_s()));
  const double time_s = one.machine().time_s();
  const ComponentValues a = one.errors().at(one.machine().state(), one.heat());
  const ComponentValues b = many.errors().at(many.machine().state(), many.heat());
  for (std::size_t c = 0; c < kComponents; ++c) CHECK(a[c] == Approx(b[c]).epsilon(1e-9));
  CHECK(one.material_degC() == Approx(many.material_degC()).epsilon(1e-12));
  CHECK(one.air().temperature_degC == Approx(one.heat().air(time_s).temperature_degC));
}

TEST_CASE("air and material of the simulation are those of the file") {
  Simulation simulation = simulation_of("[air]\nmean_degC = 23.5\npressure_hPa = 985.0\nhumidity_pct = 30.0\n");
  CHECK(simulation.air().temperature_degC == Approx(23.5));
  CHECK(simulation.air().pressure_hPa == Approx(985.0));
  CHECK(simulation.air().humidity_pct == Approx(30.0));
  CHECK(simulation.material_degC() == Approx(23.5));
}

TEST_CASE("formulas see the sensors' true temperatures") {
  Simulation simulation = simulation_of(R"([air]
mean_degC = 24.0
[sensor.hall]
of = "air"
offset_degC = 3.0
[[contribution]]
component = "EZZ"
formula = "T_hall"
)");
  CHECK(simulation.errors().at(simulation.machine().state(), simulation.heat())[index_of(Component::EZZ)] ==
        Approx(24.0));
}

TEST_CASE("every wrong word about heat is refused with its line") {
  const std::string text = refused_errors(R"([air]
mean_degC = 20
humidity_pct = 120
swnig_degC = 2
[material]
lag_s = 0
[spindle]
growth_um_per_degC = 1
tilt = "EX"
steps = [[0, 100], [0, 200]]
[screw.X]
fixed_bearing_mm = 0
friction_N = -1
heat_capacity_J_per_m_degC = 1000
cell_mm = 2
feedback = "motor"
[sensor.one]
of = "oven"
[sensor.two]
of = "screw_Y"
at_mm = 0
[sensor.three]
of = "air"
at_mm = 4
[sensor.four]
of = "screw_X"
[sensor.oil]
of = "air"
noise_degC = -1
[temperature]
oil = "20"
)");
  for (const int line : {3, 4, 6, 7, 9, 10, 11, 13, 16, 18, 20, 24, 25, 27, 29})
    CHECK_MESSAGE(contains(text, "errors.toml:" + std::to_string(line) + ":"), line << " in " << text);
  CHECK_MESSAGE(contains(text, "cell_mm: expected at least 6.9"), text);
}

TEST_CASE("the warm mill of the samples: droop, bed, spindle and day are as its comments say") {
  auto simulation = must(simulation_for("samples/warm_mill/machine.toml", {}, std::nullopt, ""));
  MachineState state = simulation.machine().state();
  const auto value = [&](Component c) { return simulation.errors().at(state, simulation.heat())[index_of(c)]; };
  state.position_mm = {-750.0, 0.0, -500.0};
  // 2451.66*0.2401/1.92e8 + 784.532*0.343/7.2e7 and 34323.3*4.913/2.88e10
  CHECK(value(Component::EYZ) == Approx(-6.803).epsilon(1e-3));
  CHECK(value(Component::EYX) == Approx(-5.855).epsilon(1e-3));
  simulation.spindle(6000.0);
  REQUIRE(simulation.dwell(4.0 * 1800.0));
  state.time_s = simulation.machine().time_s();
  state.position_mm[2] = 50.0;  // at the bearing of the screw: what the air does to it does not count
  CHECK(value(Component::EZZ) == Approx(-2.4 * 21.0 * (1.0 - std::exp(-4.0))).epsilon(1e-3));
}

TEST_CASE("the state of the workshop shows sensors and air where there are any") {
  Simulation warm = simulation_of(kWarmMachine);
  const std::string shown = perform({&warm, nullptr, nullptr}, R"({"action": "state"})");
  check_holds(shown, {"\"sensors_degC\":{\"far_end\":", "\"oil\":30.0", "\"air\":{", "\"hPa\":"});
  Simulation bare = simulation_of("");
  CHECK(!contains(perform({&bare, nullptr, nullptr}, R"({"action": "state"})"), "degC"));
}

TEST_CASE("a workpiece put on the table shows in what the tool does") {
  Simulation simulation = simulation_of(R"([gravity]
direction = "-Z"
[table.X]
stiffness_N_um = 400.0
base_mm = 600.0
load_at_mm = -250.0
)",
                                        small_machine("XTYZ"));
  REQUIRE(simulation.move_to({-250.0, 0.0, 0.0}, 0.0));
  const double before_um = simulation.tool_now(false).error_um[2];
  const std::string answer = perform({&simulation, nullptr, nullptr}, R"({"action": "load", "kg": 400})");
  CHECK_MESSAGE(contains(answer, "\"ok\":true"), answer);
  CHECK(simulation.tool_now(false).error_um[2] - before_um == Approx(400.0 * 9.80665 / 400.0));
}
