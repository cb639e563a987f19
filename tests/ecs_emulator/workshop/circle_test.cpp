// A ball bar on machines whose errors are known: what it reads at an angle, in each plane and direction.
#include <numbers>

#include "ecs_emulator/workshop/procedures.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

constexpr std::array<std::array<Axis, 2>, 4> kPlanes{
    {{Axis::X, Axis::Y}, {Axis::Y, Axis::Z}, {Axis::Z, Axis::X}, {Axis::X, Axis::Z}}};

CirclePlan circle_in(const std::array<Axis, 2>& plane) {
  return {.plane = plane,
          .centre_mm = {-250.0, -200.0, -150.0},
          .radius_mm = 80.0,
          .feed_mm_min = 600.0,
          .step_deg = 5.0,
          .runs = 1,
          .noise_um = 0.0};
}

laser::CircleTest contoured(const std::string& errors, const CirclePlan& plan) {
  Simulation simulation(machine_of(ideal_machine()), errors_of(errors), 1);
  return must(contour_circle(simulation, plan));
}

std::string effect(const std::string& id, Axis axis, const std::string& parameters) {
  return "[[effect]]\nid = \"" + id + "\"\naxis = \"" + letter_of(axis) + "\"\nparameters = { " + parameters + " }\n";
}

/// A loop of Kv = 30/s at 10 mm/s: the circle is smaller by R(1 − 1/√(1 + (v/(R Kv))²)).
constexpr double kLag_um = -1000.0 * (10.0 / 30.0) * (10.0 / 30.0) / (2.0 * 80.0);

}  // namespace

TEST_CASE("a perfect machine is round, smaller by the lag of its drives, both ways, in every plane") {
  for (const auto& plane : kPlanes) {
    CAPTURE(laser::plane_name(plane));
    const laser::CircleTest test = contoured("", circle_in(plane));
    REQUIRE(test.readings.size() == 144);
    CHECK(std::count_if(test.readings.begin(), test.readings.end(), [](const auto& r) { return r.clockwise; }) == 72);
    for (const laser::CircleReading& reading : test.readings) CHECK(std::abs(reading.deviation_um - kLag_um) < 0.05);
    CHECK(test.plane == plane);
  }
}

TEST_CASE("a scale error of 100 um/m of the second axis is 8 um at its ends and none at those of the first") {
  for (const auto& plane : kPlanes) {
    CAPTURE(laser::plane_name(plane));
    CirclePlan plan = circle_in(plane);
    plan.centre_mm = {-250.0, -200.0, -150.0};
    const laser::CircleTest test = contoured(effect("scale", plane[1], "um_per_m = 100.0"), plan);
    const double at_centre_um = 0.1 * plan.centre_mm[index_of(plane[1])];
    for (const laser::CircleReading& reading : test.readings) {
      const double s = std::sin(reading.angle_deg * std::numbers::pi / 180.0);
      CHECK(std::abs(reading.deviation_um - kLag_um - at_centre_um * s - 8.0 * s * s) < 0.1);
    }
  }
}

TEST_CASE("backlash steps where its axis turns round, the other way in the other direction") {
  const laser::CircleTest test = contoured(effect("backlash", Axis::X, "um = 6.0"), circle_in({Axis::X, Axis::Y}));
  for (const laser::CircleReading& reading : test.readings) {
    const double angle = reading.angle_deg * std::numbers::pi / 180.0;
    if (std::abs(std::sin(angle)) < 0.1) continue;
    const double motion = (std::sin(angle) > 0.0) != reading.clockwise ? -1.0 : 1.0;
    CHECK(std::abs(reading.deviation_um - kLag_um - 3.0 * motion * std::cos(angle)) < 0.05);
  }
}

TEST_CASE("a position loop that is slower turns the circle into an ellipse that leans by the direction") {
  std::string text = ideal_machine();
  text.replace(text.find("[emulator.axis.Y]"), 17, "[emulator.axis.Y]\nkv_per_s = 29.0");
  Simulation simulation(machine_of(text), errors_of(""), 1);
  const auto test = must(contour_circle(simulation, circle_in({Axis::X, Axis::Y})));
  double ccw = 0.0, cw = 0.0;
  for (const laser::CircleReading& reading : test.readings)
    (reading.clockwise ? cw : ccw) +=
        reading.deviation_um * std::sin(reading.angle_deg * std::numbers::pi / 90.0) / 36.0;
  CHECK(ccw == Approx(-cw).epsilon(0.05));
  CHECK(std::abs(ccw) == Approx(10.0 * (1.0 / 29.0 - 1.0 / 30.0) / 2.0 * 1000.0).epsilon(0.1));  // v (1/Kv − 1/Kv')/2
}

TEST_CASE("a circle beyond the travel, or none, is refused") {
  Simulation simulation(machine_of(ideal_machine()), errors_of(""), 1);
  CirclePlan plan = circle_in({Axis::X, Axis::Y});
  plan.radius_mm = 400.0;
  CHECK(must_fail(contour_circle(simulation, plan)).kind == ProblemKind::usage);
  plan = circle_in({Axis::X, Axis::X});
  CHECK(contains(must_fail(contour_circle(simulation, plan)).message, "plane: expected two axes"));
}
