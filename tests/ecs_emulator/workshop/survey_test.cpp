#include "ecs_emulator/workshop/procedures.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

TEST_CASE("the survey finds the corner where squareness and scale add up, counted from the datum") {
  auto simulation = simulation_of(
      "[squareness]\nC0Y = 100.0\n"
      "[[contribution]]\ncomponent = \"EZZ\"\nformula = \"0.1*p + 7\"\n");
  const auto found = must(survey(simulation, {.step_mm = 200.0}));
  CHECK(found.corners.size() == 8);
  CHECK(found.grid.size() == 4 * 3 * 3);
  CHECK(worst(found.corners).length_um() == Approx(std::hypot(40.0, 30.0)).epsilon(1e-3));
  CHECK(worst(found.corners).position_mm[1] == -400.0);
  CHECK(worst(found.corners).position_mm[2] == -300.0);
}

TEST_CASE("every point of a survey is approached from the stated side") {
  const std::string errors = "[[contribution]]\ncomponent = \"EXX\"\nformula = \"4*d*(p<-100)\"\n";
  for (const auto approach : {Approach::forward, Approach::reverse}) {
    auto simulation = simulation_of(errors, ideal_machine());
    const auto found = must(survey(simulation, {.step_mm = 250.0, .approach = approach}));
    for (const auto& point : found.grid)
      CHECK(point.error_um[0] ==
            Approx(point.position_mm[0] < -100.0 ? 4.0 * static_cast<int>(approach) : 0.0).epsilon(1e-3));
  }
}
