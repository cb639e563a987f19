// Squares and straight edges with errors of their own: turned over, these change their sign.
#include <cmath>

#include <doctest/doctest.h>

#include "ecs_emulator/instruments/measurement.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;
using doctest::Approx;

namespace {

laser::MeasurementSet across(const std::string& errors, Axis axis, Sense sense, InstrumentKind kind,
                             std::optional<bool> reversed) {
  auto simulation = simulation_of(errors, ideal_machine());
  MeasurementPlan plan;
  plan.axis = axis;
  plan.sense = sense;
  plan.instrument = kind;
  plan.targets_mm = targets_between(0.0, -400.0, 100.0);
  plan.runs = 1;
  plan.feed_mm_min = 6000.0;
  plan.dwell_s = 0.5;
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
    MeasurementPlan plan;
    plan.axis = Axis::Y;
    plan.sense = Sense::EX;
    plan.instrument = InstrumentKind::square;
    plan.targets_mm = {0.0, -400.0};
    plan.runs = 1;
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
  const auto set = measure(simulation, plan);
  REQUIRE_FALSE(set.has_value());
  CHECK(to_text(set.error()).find("reversed: expected straightness or square") != std::string::npos);
}

TEST_CASE("an artefact along its axis, without an error or on an axis that is not there is refused with its line") {
  CHECK(refused_errors("[[artefact]]\naxis = \"X\"\nsense = \"EX\"\nangle_um_per_m = 1.0\n")
            .find("artefact: sense: expected EX, EY or EZ other than along X, got \"EX\"") != std::string::npos);
  CHECK(refused_errors("[[artefact]]\naxis = \"X\"\nsense = \"EY\"\n").find("expected angle_um_per_m, or a form") !=
        std::string::npos);
  CHECK(refused_errors("[[artefact]]\naxis = \"X\"\nsense = \"EY\"\nangle = 1.0\n").find("angle") != std::string::npos);
  const auto lathe = machine_of(
      "name = \"lathe\"\nconfiguration = \"XTZ\"\n[axis.X]\ntravel_mm = [0, 100]\n[axis.Z]\ntravel_mm = [0, 100]\n");
  const auto checked =
      errors_of("[[artefact]]\naxis = \"Y\"\nsense = \"EX\"\nangle_um_per_m = 1.0\n").checked_for(lathe.machine);
  REQUIRE_FALSE(checked.has_value());
  CHECK(to_text(checked.error()).find("artefact: this machine has no Y") != std::string::npos);
}
