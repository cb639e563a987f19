#include "ecs_emulator/workshop/procedures.hpp"

#include "tests/ecs_emulator/support/emulated_unit.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

Simulation one_axis(const std::string& axis_settings) {
  return simulation_of(
      "", "configuration = \"TX\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n[emulator.axis.X]\n" + axis_settings + "\n");
}

std::string alarm_of(Simulation& simulation) {
  const auto referenced = reference(simulation, {Axis::X});
  return referenced ? "" : referenced.error().message;
}

constexpr const char* kFamilies[] = {"fanuc", "allen_bradley", "siemens"};

}  // namespace

TEST_CASE("a control of any family ends on its reference position, to a pulse, from either direction") {
  for (const std::string family : kFamilies)
    for (const std::string direction : {"1", "-1"}) {
      CAPTURE(family);
      CAPTURE(direction);
      auto simulation =
          one_axis("null_offset_mm = 3.0\nreference_kind = \"" + family + "\"\nreference_direction = " + direction);
      CHECK(alarm_of(simulation) == "");
      CHECK(std::abs(simulation.machine().axis(Axis::X).position_mm()) < 0.0011);
    }
}

TEST_CASE("the switch is crossed at reference speed and the marker taken at creep speed") {
  auto simulation = one_axis("reference_speed_mm_min = 1200.0\ncreep_speed_mm_min = 120.0");
  const AxisOfMachine& axis = simulation.machine().axis(Axis::X);
  double before_mm = axis.position_mm();
  bool on_switch = false;
  double onto_switch_mm_s = 0.0;
  std::optional<double> at_marker_mm_s;
  simulation.on_pause([] { return true; });
  // the reference cycle drives the simulation; what it does is watched through the unit's end of the wires
  struct Watch final : Compensator {
    std::function<void(const Signals&)> look;
    Drives tick(const Signals& signals) override {
      look(signals);
      return {};
    }
    double period_s() const override { return 1e-3; }
    bool quiet() const override { return true; }
  } watch;
  watch.look = [&](const Signals& signals) {
    const double speed_mm_s = (axis.position_mm() - before_mm) * 1e3;
    before_mm = axis.position_mm();
    if (signals[0].switch_closed && !on_switch) onto_switch_mm_s = speed_mm_s;
    on_switch = on_switch || signals[0].switch_closed;
    if (on_switch && signals[0].marker && !at_marker_mm_s && !signals[0].switch_closed) at_marker_mm_s = speed_mm_s;
  };
  simulation.attach(&watch);
  CHECK(alarm_of(simulation) == "");
  CHECK(onto_switch_mm_s == Approx(20.0).epsilon(0.02));
  REQUIRE(at_marker_mm_s.has_value());
  CHECK(*at_marker_mm_s == Approx(2.0).epsilon(0.05));
}

TEST_CASE("a failed datum search is an alarm, and the machine stops") {
  for (const std::string family : kFamilies) {
    CAPTURE(family);
    auto simulation = one_axis("reference_kind = \"" + family + "\"");
    AxisOfMachine& axis = simulation.machine().axis(Axis::X);
    axis.hang_switch(false);
    CHECK(alarm_of(simulation) == "X: alarm of the control: the reference switch was not met before the end of travel");
    CHECK(axis.position_mm() <= 26.0);
    axis.hang_switch(std::nullopt);
    axis.lose_marker(true);
    CHECK(contains(alarm_of(simulation), "marker"));
    axis.lose_marker(false);
    CHECK(alarm_of(simulation) == "");
  }
  auto simulation = one_axis("");
  simulation.machine().axis(Axis::X).hang_switch(true);
  CHECK(alarm_of(simulation) == "X: alarm of the control: the reference switch did not open within 120 mm");
}

TEST_CASE("lost counts are gone once the machine is referenced again") {
  auto simulation = one_axis("[emulator.axis.X.transducer]\ndirt_mm = -250.0\ndirt_counts = 500\n");
  CHECK(alarm_of(simulation) == "");
  REQUIRE(simulation.move_to({-300.0, 0.0, 0.0}, 6000.0));
  const double off_um = std::abs(simulation.machine().axis(Axis::X).position_mm() + 300.0) * 1e3;
  CHECK(off_um > 2.0);
  CHECK(alarm_of(simulation) == "");
  CHECK(std::abs(simulation.machine().axis(Axis::X).position_mm()) < 0.0011);
}

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
