// Measuring the machine; squares and straight edges with errors of their own: turned over, these change their sign.
#include "ecs_emulator/instruments/measurement.hpp"

#include "laser/writers/writers.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

MeasurementPlan plan_for(Axis axis, Sense sense, double from_mm, double to_mm, double step_mm) {
  return {.axis = axis,
          .sense = sense,
          .targets_mm = targets_between(from_mm, to_mm, step_mm),
          .runs = 1,
          .feed_mm_min = 6000.0};
}

laser::MeasurementSet across(const std::string& errors, Axis axis, Sense sense, InstrumentKind kind,
                             std::optional<bool> reversed) {
  auto simulation = simulation_of(errors, ideal_machine());
  MeasurementPlan plan{.axis = axis,
                       .sense = sense,
                       .instrument = kind,
                       .targets_mm = targets_between(0.0, -400.0, 100.0),
                       .runs = 1,
                       .feed_mm_min = 6000.0,
                       .dwell_s = 0.5};
  plan.setting.reversed = reversed;
  return measured(simulation, plan);
}

double at(const laser::MeasurementSet& set, double target_mm) {
  return reading_at(set, target_mm, Approach::reverse) - reading_at(set, 0.0, Approach::reverse);
}

constexpr const char* kEdge = R"(
[[contribution]]
component = "EYX"
formula = "0.01*p"
[[artefact]]
axis = "X"
sense = "EY"
formula = "p < -150 ? 6 : 0"
)";

constexpr const char* kSquare = R"(
[squareness]
C0Y = 30.0
[[artefact]]
axis = "Y"
sense = "EX"
angle_um_per_m = 8.0
)";

}  // namespace

TEST_CASE("linear optics see scale error and backlash, zeroed at the first target") {
  auto simulation =
      simulation_of("[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p + 1.5*d\"\n", ideal_machine());
  const auto set = measured(simulation, plan_for(Axis::X, Sense::EX, 0.0, -500.0, 100.0));
  CHECK(set.readings.size() == 12);
  CHECK(reading_at(set, 0.0, Approach::reverse) == Approx(0.0));
  CHECK(reading_at(set, -300.0, Approach::reverse) == Approx(-6.0).epsilon(1e-3));
  CHECK(reading_at(set, -300.0, Approach::forward) == Approx(-3.0).epsilon(1e-3));
}

TEST_CASE("a parked axis levers an angle into the positioning error, away from the measurement line only") {
  const std::string errors = "[[contribution]]\ncomponent = \"ECX\"\nformula = \"0.1*p\"\n";  // um/m
  auto simulation = simulation_of(errors, ideal_machine());
  auto plan = plan_for(Axis::X, Sense::EX, 0.0, -500.0, 500.0);
  CHECK(reading_at(measured(simulation, plan), -500.0, Approach::reverse) == Approx(0.0).epsilon(1e-3));
  plan.parked_mm[1] = -400.0;  // E_X = −ECX·Y = −(−50 um/m)·(−0.4 m)
  CHECK(reading_at(measured(simulation, plan), -500.0, Approach::reverse) == Approx(-20.0).epsilon(1e-3));
}

TEST_CASE("angular optics and the level see the rotation of the tool against the workpiece") {
  auto simulation = simulation_of(
      "[[contribution]]\ncomponent = \"EBX\"\nformula = \"0.1*p\"\n"
      "[[contribution]]\ncomponent = \"EAX\"\nformula = \"-0.2*p\"\n");
  CHECK(reading_at(measured(simulation, plan_for(Axis::X, Sense::EB, 0.0, -400.0, 200.0)), -400.0, Approach::forward) ==
        Approx(-40.0).epsilon(1e-3));
  CHECK(reading_at(measured(simulation, plan_for(Axis::X, Sense::EA, 0.0, -400.0, 200.0)), -400.0, Approach::forward) ==
        Approx(80.0).epsilon(1e-3));
}

TEST_CASE("a straightness reading carries the slope and offset of its set-up, other than that it is the error") {
  Simulation simulation(machine_of(small_machine() + R"(
[emulator.laser]
straightness_noise_um = 0
straightness_resolution_um = 0
)"),
                        errors_of("[[contribution]]\ncomponent = \"EYX\"\nformula = \"10*sin(pi*p/500)\"\n"), 3);
  const auto set = measured(simulation, plan_for(Axis::X, Sense::EY, 0.0, -500.0, 250.0));
  const double left = reading_at(set, 0.0, Approach::forward);
  const double right = reading_at(set, -500.0, Approach::forward);
  CHECK(std::abs(left - right) > 0.1);
  CHECK(reading_at(set, -250.0, Approach::forward) - 0.5 * (left + right) == Approx(-10.0).epsilon(1e-3));
}

TEST_CASE("an indicator against a square reads the squareness, the tilt of the first leg taken out") {
  auto simulation = simulation_of(
      "[squareness]\nC0Y = 30.0\n"
      "[[contribution]]\ncomponent = \"EYX\"\nformula = \"0.05*p\"\n");  // the X line rises by 50 um/m
  auto plan = plan_for(Axis::Y, Sense::EX, 0.0, -400.0, 200.0);
  plan.instrument = InstrumentKind::square;
  // E_X = −C0Y·Y = +12 um at −0.4 m; the square, turned with the X line, stands at −50 um/m: E_X + 50·Y = 12 − 20.
  CHECK(reading_at(measured(simulation, plan), -400.0, Approach::reverse) == Approx(-8.0).epsilon(1e-3));
}

TEST_CASE("a reading on the fly is taken where the axis passes, and lags with the feed") {
  auto simulation = simulation_of("[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p\"\n",
                                  small_machine() + "[emulator.axis.X]\nservo_lag_um_per_m_min = 0.5\n");
  auto plan = plan_for(Axis::X, Sense::EX, 0.0, -500.0, 10.0);
  plan.on_the_fly = true;
  plan.feed_mm_min = 4000.0;
  const auto set = measured(simulation, plan);
  CHECK(set.readings.size() == 102);
  CHECK(reading_at(set, -250.0, Approach::reverse) == Approx(-5.0).epsilon(1e-3));
  CHECK(reading_at(set, -250.0, Approach::forward) == Approx(-5.0 + 2.0 + 2.0).epsilon(1e-3));
  CHECK(set.readings.front().feed_mm_min == 4000.0);
}

TEST_CASE("the same seed gives the same bytes, another seed other ones") {
  const auto csv = [](std::uint64_t seed) {
    Simulation simulation(machine_of(small_machine()), errors_of("[scatter]\nEXX = { pass = 1.0, reading = 0.3 }\n"),
                          seed);
    return laser::to_csv(measured(simulation, plan_for(Axis::X, Sense::EX, 0.0, -500.0, 50.0)));
  };
  CHECK(csv(5) == csv(5));
  CHECK(csv(5) != csv(6));
}

TEST_CASE("a tool offset levers the angles of the axis that carries it") {
  auto simulation = simulation_of("[[contribution]]\ncomponent = \"ECX\"\nformula = \"0.1*p\"\n",
                                  ideal_machine() + "[emulator]\ntool_offset_mm = { y = 200.0 }\n");
  const auto set = measured(simulation, plan_for(Axis::X, Sense::EX, 0.0, -500.0, 500.0));
  CHECK(reading_at(set, -500.0, Approach::reverse) == Approx(10.0).epsilon(1e-3));  // −ECX·Y
}

TEST_CASE("a plan that cannot be followed is refused with the reason") {
  auto simulation = simulation_of("", "configuration = \"TX\"\n[axis.X]\ntravel_mm = [0.0, 100.0]\n");
  auto plan = plan_for(Axis::X, Sense::EX, 0.0, 500.0, 100.0);
  CHECK(!measure(simulation, plan).has_value());
  plan = plan_for(Axis::Y, Sense::EY, 0.0, 50.0, 10.0);
  CHECK(!measure(simulation, plan).has_value());
  plan = plan_for(Axis::X, Sense::EX, 0.0, 100.0, 50.0);
  plan.instrument = InstrumentKind::angular;
  CHECK(!measure(simulation, plan).has_value());
  plan.instrument.reset();
  plan.targets_mm = {0.0, 50.0, 25.0};
  CHECK(!measure(simulation, plan).has_value());
}

TEST_CASE("targets include both ends, in either direction") {
  CHECK(targets_between(0.0, -100.0, 40.0) == std::vector<double>{0.0, -40.0, -80.0, -100.0});
  CHECK(targets_between(0.0, 100.0, 50.0) == std::vector<double>{0.0, 50.0, 100.0});
  CHECK(targets_between(0.0, 100.0, 0.0).empty());
}

TEST_CASE("the form of a straight edge is in its readings, with the other sign when it is turned over") {
  for (const auto& [reversed, side] :
       {std::pair<std::optional<bool>, double>{std::nullopt, 1.0}, {false, 1.0}, {true, -1.0}}) {
    const auto set = across(kEdge, Axis::X, Sense::EY, InstrumentKind::straightness, reversed);
    CHECK(at(set, -100.0) == Approx(-1.0).epsilon(0.02));
    CHECK(at(set, -200.0) == Approx(-2.0 + 6.0 * side).epsilon(0.02));
  }
}

TEST_CASE("a square's angle error leans the readings, the other way when it is turned over; the machine's stays") {
  const double first = at(across(kSquare, Axis::Y, Sense::EX, InstrumentKind::square, false), -400.0);
  const double turned = at(across(kSquare, Axis::Y, Sense::EX, InstrumentKind::square, true), -400.0);
  CHECK(0.5 * (first + turned) == Approx(12.0).epsilon(0.01));  // −C0Y·Y
  CHECK(0.5 * (first - turned) == Approx(-3.2).epsilon(0.01));  // 8 um/m over −0.4 m
}

TEST_CASE("the column is written where the request speaks of it, on no other line the artefact acts") {
  CHECK(across(kEdge, Axis::X, Sense::EY, InstrumentKind::straightness, std::nullopt).readings.front().extras.empty());
  const auto turned = across(kEdge, Axis::X, Sense::EY, InstrumentKind::straightness, true);
  CHECK(turned.readings.front().extras.at("reversed") == 1.0);
  CHECK(std::abs(at(across(kEdge, Axis::X, Sense::EZ, InstrumentKind::straightness, true), -200.0)) < 0.01);
}

TEST_CASE("the error of the square in the machine file turns over as well") {
  const auto shown = [](bool reversed) {
    Simulation simulation(machine_of(ideal_machine() + kPerfectInstruments + "square_error_um_per_m = 10\n"),
                          errors_of(""), 1);
    MeasurementPlan plan{.axis = Axis::Y,
                         .sense = Sense::EX,
                         .instrument = InstrumentKind::square,
                         .targets_mm = {0.0, -400.0},
                         .runs = 1};
    plan.setting.reversed = reversed;
    return at(measured(simulation, plan), -400.0);
  };
  CHECK(shown(false) == Approx(-4.0).epsilon(0.01));
  CHECK(shown(true) == Approx(4.0).epsilon(0.01));
}

TEST_CASE("optics without an artefact have nothing to turn over") {
  auto simulation = simulation_of("");
  MeasurementPlan plan;
  plan.targets_mm = {0.0, -100.0};
  plan.setting.reversed = true;
  CHECK(contains(to_text(must_fail(measure(simulation, plan))), "reversed: expected straightness or square"));
}

TEST_CASE("an artefact along its axis, without an error or on an axis that is not there is refused with its line") {
  CHECK(refused_errors("[[artefact]]\naxis = \"X\"\nsense = \"EX\"\nangle_um_per_m = 1.0\n")
            .find("artefact: sense: expected EX, EY or EZ other than along X, got \"EX\"") != std::string::npos);
  CHECK(contains(refused_errors("[[artefact]]\naxis = \"X\"\nsense = \"EY\"\n"), "expected angle_um_per_m, or a form"));
  CHECK(contains(refused_errors("[[artefact]]\naxis = \"X\"\nsense = \"EY\"\nangle = 1.0\n"), "angle"));
  const auto lathe = machine_of(
      "name = \"lathe\"\nconfiguration = \"XTZ\"\n[axis.X]\ntravel_mm = [0, 100]\n[axis.Z]\ntravel_mm = [0, 100]\n");
  const auto checked = must_fail(
      errors_of("[[artefact]]\naxis = \"Y\"\nsense = \"EX\"\nangle_um_per_m = 1.0\n").checked_for(lathe.machine));
  CHECK(contains(to_text(checked), "artefact: this machine has no Y"));
}
