#include "ecs_emulator/machine/simulation.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

void go(Simulation& simulation, const Vector3& target_mm) { REQUIRE(simulation.move_to(target_mm, 6000.0)); }

double error_x_um(Simulation& simulation) { return simulation.tool_now(true).error_um[0]; }

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
    CHECK(error_x_um(simulation) == doctest::Approx(parked_um).epsilon(1e-9));
  }
  go(simulation, {-100.0, -60.0, 0.0});
  CHECK(std::abs(error_x_um(simulation) - parked_um) > 1e-6);
}

TEST_CASE("a repeated stop draws anew, with the standard deviation of the errors file") {
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
  CHECK(std::abs(sum_um / kStops) < 0.3);                                       // three times 2 / √400
  CHECK(std::sqrt(square_um2 / kStops) == doctest::Approx(2.0).epsilon(0.12));  // three times 2 / √800
}
