// Instruments at the machine: what is set at them reaches the readings, on the fly, point by point and in captures.
#include "ecs_emulator/instruments/interferometer.hpp"
#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/workshop/workshop.hpp"
#include "laser/writers/writers.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Instruments without noise and what `settings` says; whole pulses of the drive are left out of the errors.
Simulation workshop(const std::string& settings, const std::string& errors = "") {
  return Simulation(machine_of(small_machine() + kPerfectInstruments + settings), errors_of(errors), 1);
}

MeasurementPlan x_plan() {
  MeasurementPlan plan{
      .targets_mm = targets_between(0.0, -500.0, 100.0), .runs = 1, .feed_mm_min = 6000.0, .dwell_s = 0.5};
  return plan;
}

/// What `changed` shows more than `plain`, at a target of the way out.
double more(const laser::MeasurementSet& changed, const laser::MeasurementSet& plain, double target_mm) {
  return reading_at(changed, target_mm, Approach::reverse) - reading_at(plain, target_mm, Approach::reverse);
}

constexpr const char* kWarmDay = "[air]\nmean_degC = 25.0\npressure_hPa = 990.0\nhumidity_pct = 40.0\n";

}  // namespace

TEST_CASE("air compensation can be switched off for one measurement: p times the change of the index remains") {
  auto automatic = workshop("", kWarmDay);
  auto off = workshop("", kWarmDay);
  auto plan = x_plan();
  const auto plain = measured(automatic, plan);
  plan.setting.air = Compensation::off;
  // 5 °C more and 23.25 hPa less: −4.73e-6 − 6.2e-6 and 10 % less: +0.1e-6; −0.5 m of it
  const double change = refractive_index({25.0, 990.0, 40.0}) - refractive_index(kReferenceAir);
  CHECK(change == Approx(-10.75e-6).epsilon(0.02));
  CHECK(more(measured(off, plan), plain, -500.0) == Approx(-0.5e6 * change).epsilon(1e-3));
}

TEST_CASE("readings carry the weather as the instrument's own sensors see it, where there is weather") {
  auto indoors = workshop("");
  CHECK(!measured(indoors, x_plan()).readings.front().pressure_hPa.has_value());
  auto outdoors = workshop(
      "air_sensor_error_degC = 0.5\npressure_sensor_error_hPa = -2\nmaterial_sensor_error_degC = 1\n", kWarmDay);
  const laser::Reading reading = measured(outdoors, x_plan()).readings.back();
  CHECK(*reading.pressure_hPa == Approx(988.0));
  CHECK(*reading.humidity_pct == Approx(40.0));
  CHECK(reading.sensors_degC.at("t_air_degC") == Approx(25.5));
  CHECK(reading.sensors_degC.at("t_material_degC") == Approx(26.0));
}

TEST_CASE("while the air warms a dead path shows its change, and manual compensation what it was entered for") {
  const std::string day = "[air]\nmean_degC = 20.0\nswing_degC = 8.0\nwarmest_h = 15.0\nstart_h = 9.0\n";
  const auto run = [&](const std::string& settings, const InstrumentSetting& setting) {
    auto simulation = workshop(settings, day);
    auto plan = x_plan();
    plan.dwell_s = 900.0;
    plan.setting = setting;
    const auto set = measured(simulation, plan);
    return std::pair{set, simulation.air()};
  };
  const auto [plain, air_at_end] = run("", {});
  InstrumentSetting dead;
  dead.dead_path_m = 1.5;
  const auto [with_dead_path, same_air] = run("", dead);
  CHECK(air_at_end.temperature_degC > 25.0);
  // Back at the first target, the reflector as far away as at the reset: nothing but the dead path has changed.
  const laser::Reading& first = plain.readings.front();
  const Air before{first.sensors_degC.at("t_air_degC"), 1013.25, 50.0};
  const double change = refractive_index(air_at_end) - refractive_index(before);
  CHECK(with_dead_path.readings.back().error - plain.readings.back().error ==
        Approx(-1.5e6 * change).epsilon(5e-3));  // the laser stands on the + side
  InstrumentSetting manual;
  manual.air = Compensation::manual;
  const auto [held, again] = run("", manual);
  const double far = held.readings[5].error - plain.readings[5].error;  // at −500 mm, an hour and a quarter later
  const double then_degC = plain.readings[5].sensors_degC.at("t_air_degC");
  CHECK(far ==
        Approx(-0.5e6 * (refractive_index({then_degC, 1013.25, 50.0}) - refractive_index(before))).epsilon(5e-3));
}

TEST_CASE("a late trigger reads further along the motion: feed times latency") {
  auto plan = x_plan();
  plan.targets_mm = targets_between(-50.0, -450.0, 50.0);
  plan.overrun_mm = 20.0;
  plan.on_the_fly = true;
  for (const double feed_mm_min : {3000.0, 6000.0}) {
    plan.feed_mm_min = feed_mm_min;
    plan.setting.trigger_latency_s = 0.0;
    auto prompt = workshop("");
    const auto plain = measured(prompt, plan);
    plan.setting.trigger_latency_s = 0.0005;
    auto late = workshop("");
    const auto set = measured(late, plan);
    const double expected_um = feed_mm_min / 60.0 * 0.0005 * 1e3;  // 50 mm/s: 25 um
    // The display was set to zero late as well, on the way out: what is left is twice the lag on the way back.
    CHECK(std::abs(more(set, plain, -250.0)) < 0.3);
    CHECK(reading_at(set, -250.0, Approach::forward) - reading_at(plain, -250.0, Approach::forward) ==
          Approx(2.0 * expected_um).epsilon(0.01));
  }
}

TEST_CASE("an instrument with a clock of its own reads at its next tick: late by at most one") {
  auto plan = x_plan();
  plan.targets_mm = targets_between(-50.0, -450.0, 7.37);  // 73.7 ticks of the clock
  plan.overrun_mm = 20.0;
  plan.on_the_fly = true;
  auto prompt = workshop("");
  auto clocked = workshop("trigger_rate_Hz = 1000\n");
  const auto plain = measured(prompt, plan);
  const auto set = measured(clocked, plan);
  double least_um = 1e9;
  double most_um = -1e9;
  for (std::size_t i = 0; i < 54; ++i) {  // on the way out
    const double late_um = plain.readings[i].error - set.readings[i].error;
    least_um = std::min(least_um, late_um);
    most_um = std::max(most_um, late_um);
  }
  CHECK(most_um - least_um < 100.1);  // 100 mm/s for 1 ms
  CHECK(most_um - least_um > 85.0);
}

TEST_CASE("a broken beam ends the measurement and is reported with its place; a level is not affected") {
  auto simulation = workshop("");
  auto plan = x_plan();
  plan.beam_broken_at = 4;
  const auto set = must_fail(measure(simulation, plan));
  CHECK(set.kind == ProblemKind::refused);
  CHECK(contains(set.message, "before reading 4 (X -300 mm, run 1, reverse)"));
  plan.on_the_fly = true;
  plan.targets_mm = targets_between(-50.0, -450.0, 50.0);
  CHECK(!measure(simulation, plan).has_value());
  plan.beam_broken_at.reset();
  CHECK(measure(simulation, plan).has_value());  // set up again, all is well
  plan.beam_broken_at = 2;
  plan.sense = Sense::EA;
  CHECK(measure(simulation, plan).has_value());
}

TEST_CASE("a level that settles slowly reads low after a short dwell") {
  const std::string roll = "[[contribution]]\ncomponent = \"EAX\"\nformula = \"-0.2*p\"\n";
  auto plan = x_plan();
  plan.sense = Sense::EA;
  plan.targets_mm = {0.0, -500.0};
  plan.dwell_s = 2.0;
  auto slow = workshop("level_settling_s = 2\n", roll);
  CHECK(reading_at(measured(slow, plan), -500.0, Approach::reverse) ==
        Approx(100.0 * (1.0 - std::exp(-1.0))).epsilon(1e-3));
}

TEST_CASE("a capture follows a move sample by sample and begins at zero") {
  auto simulation = workshop("");
  REQUIRE(simulation.move_to({-100.0, 0.0, 0.0}, 0.0));
  CapturePlan plan{.rate_Hz = 500.0, .seconds = 2.0, .to_mm = -150.0, .feed_mm_min = 3000.0};
  const auto set = must(capture(simulation, plan));
  REQUIRE(set.readings.size() == 1000);
  CHECK(set.readings.front().error == Approx(0.0));
  CHECK(*set.readings[250].time_s == Approx(0.5));
  CHECK(set.readings.back().error == Approx(-50'000.0).epsilon(1e-4));  // arrived after 1 s and a bit
  const double speed_mm_s = (set.readings[350].error - set.readings[300].error) * 1e-3 / 0.1;
  CHECK(speed_mm_s == Approx(-50.0).epsilon(0.01));
  CHECK(set.readings.back().position_mm[0] == Approx(-100.0));
}

TEST_CASE("a capture of a machine at rest shows turbulence alone, the same for the same seed") {
  const auto taken = [] {
    auto simulation = workshop("turbulence_um_per_sqrt_m = 0.2\ndead_path_m = 4\nturbulence_time_s = 0.05\n");
    CapturePlan plan;
    plan.seconds = 20.0;
    return must(capture(simulation, plan));
  };
  const auto set = taken();
  double square = 0.0;
  for (const auto& reading : set.readings) square += reading.error * reading.error;
  CHECK(std::sqrt(square / static_cast<double>(set.readings.size())) == Approx(0.4).epsilon(0.15));
  CHECK(laser::to_csv(taken()) == laser::to_csv(set));
}

TEST_CASE("a capture that cannot be taken is refused with the reason") {
  auto simulation = workshop("");
  const auto because = [&](const CapturePlan& plan) {
    const auto set = capture(simulation, plan);
    return set ? std::string() : set.error().message;
  };
  CapturePlan plan;
  plan.rate_Hz = 5000.0;
  CHECK(because(plan).starts_with("rate: expected above 0 to 1000 Hz"));
  plan.rate_Hz = 1000.0;
  plan.seconds = 1000.0;
  CHECK(because(plan).starts_with("rate times seconds"));
  plan.seconds = 1.0;
  plan.to_mm = 700.0;
  CHECK(because(plan).starts_with("to: expected within the travel"));
  plan.to_mm.reset();
  plan.sense = Sense::EA;
  plan.instrument = InstrumentKind::linear;
  CHECK(because(plan).starts_with("instrument linear"));
}

TEST_CASE("what a person sets at the instrument comes with the request, and is judged there") {
  auto simulation = workshop("", kWarmDay);
  Workshop shop;
  shop.simulation = &simulation;
  const auto answer = [&](const std::string& rest) {
    return perform(shop,
                   R"({"action": "measure", "axis": "X", "sense": "EX", "targets": [0, -500], "runs": 1)" + rest + "}");
  };
  CHECK(contains(answer(R"(, "air": "off", "dead_path": 0.4, "misalignment": -1.2)"), "\"ok\":true"));
  const std::string wrong = answer(R"(, "air": "damp", "dead_path": -1, "material": "steel")");
  check_holds(wrong, {"air: expected off, manual or automatic, got", "dead_path: expected 0 or more, got -1",
                      "material: expected off, manual or automatic"});
  CHECK(contains(answer(R"(, "beam_broken_at": 2)"), "beam interrupted before reading 2"));
  const std::string captured = perform(
      shop, R"({"action": "capture", "axis": "X", "sense": "EX", "rate": 100, "seconds": 1, "to": -20, "feed": 600})");
  CHECK(contains(captured, "\"readings\":100,"));
  CHECK(contains(captured, "X,-500,0,0,EX,0,0"));  // the first sample: zero, at time zero
}

TEST_CASE("settings of the instruments are read, and every wrong one is reported with its line") {
  const auto machine = machine_of(small_machine() + R"(
[emulator.laser]
air_compensation = "manual"
material_compensation = "automatic"
dead_path_m = 0.4
dead_path_compensation = true
misalignment_mrad = -1.2
)");
  const LaserSettings& laser = machine.settings.laser;
  CHECK(laser.air_compensation == Compensation::manual);
  CHECK(laser.material_compensation == Compensation::automatic);
  CHECK(laser.dead_path_m == 0.4);
  CHECK(laser.dead_path_compensation);
  CHECK(laser.misalignment_mrad == -1.2);
  const auto wrong = must_fail(parse_workshop_machine(small_machine() + R"(
[emulator.laser]
air_compensation = "sometimes"
dead_path_m = -1
dead_path_compensation = 1
nonlinearity_cycles = 3
wavelength_nm = 10600
turbulence_time_s = 0
dead_path_mm = 400
)",
                                                      "machine.toml", "."));
  CHECK(wrong.also.size() == 6);
  CHECK(contains(to_text(wrong), "machine.toml:11:"));
}
