// Nominal and measured positions: the six freedoms of the set-up are found, told and taken out.
#include "laser/import/set_up.hpp"

#include <fmt/format.h>
#include <rapidcheck.h>

#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// Turned by small angles [rad] about X, Y, Z, then shifted [mm].
Vector3 moved(const Vector3& p, const Vector3& turn, const Vector3& shift) {
  return {p[0] + turn[1] * p[2] - turn[2] * p[1] + shift[0], p[1] + turn[2] * p[0] - turn[0] * p[2] + shift[1],
          p[2] + turn[0] * p[1] - turn[1] * p[0] + shift[2]};
}

std::vector<Vector3> cube() {
  std::vector<Vector3> points;
  for (const double x : {0.0, 100.0, 300.0})
    for (const double y : {0.0, 200.0})
      for (const double z : {0.0, 50.0, 150.0}) points.push_back({x, y, z});
  return points;
}

}  // namespace

TEST_CASE("shift and rotation of a rigid body are found") {
  const bool found = rc::check("small rotations and shifts of a cube", [] {
    const auto small = [] { return *rc::gen::inRange(-200, 200) * 1e-6; };
    const Vector3 turn{small(), small(), small()}, shift{small() * 1e4, small() * 1e4, small() * 1e4};
    std::vector<Vector3> measured;
    for (const Vector3& point : cube()) measured.push_back(moved(point, turn, shift));
    const auto set_up = rigid_set_up(cube(), measured);
    RC_ASSERT(set_up.has_value());
    for (std::size_t i = 0; i < 3; ++i) RC_ASSERT(std::abs(set_up->rotation_um_m[i] - turn[i] * 1e6) < 0.1);
    for (std::size_t k = 0; k < measured.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        RC_ASSERT(std::abs((measured[k][i] - cube()[k][i]) * 1000.0 - set_up_error_um(*set_up, cube()[k])[i]) < 0.05);
  });
  CHECK(found);
}

TEST_CASE("points in a plane, on a line and at one place tell what they can") {
  const Vector3 turn{0.0, 0.0, 1e-4};
  std::vector<Vector3> plane, turned, line, turned_line;
  for (const double x : {0.0, 100.0, 200.0}) {
    line.push_back({x, 0.0, 0.0});
    turned_line.push_back(moved(line.back(), turn, {}));
    for (const double y : {0.0, 50.0}) {
      plane.push_back({x, y, 0.0});
      turned.push_back(moved(plane.back(), turn, {}));
    }
  }
  CHECK(rigid_set_up(plane, turned)->rotation_um_m[2] == Approx(100.0).epsilon(1e-4));
  CHECK(rigid_set_up(line, turned_line)->rotation_um_m[2] == Approx(100.0).epsilon(1e-4));
  CHECK(rigid_set_up(line, turned_line)->rotations == 2);
  CHECK(rigid_set_up({{1, 2, 3}, {1, 2, 3}}, {{1, 2, 4}, {1, 2, 4}})->rotations == 0);
  CHECK_FALSE(rigid_set_up({{1, 2, 3}}, {{1, 2, 4}}).has_value());
}

TEST_CASE("a table of nominal and measured positions comes in without its set-up, and with it if asked") {
  std::string text = "x,y,z,mx,my,mz\n";
  for (const Vector3& point : cube()) {
    Vector3 at = moved(point, {1e-4, -2e-4, 3e-4}, {0.05, -0.02, 0.01});
    at[0] += 10e-6 * point[0];  // scale of X: 10 um/m
    text += fmt::format("{},{},{},{:.7f},{:.7f},{:.7f}\n", point[0], point[1], point[2], at[0], at[1], at[2]);
  }
  ImportOptions options = by_columns("x_mm=x,y_mm=y,z_mm=z,measured_x_mm=mx,measured_y_mm=my,measured_z_mm=mz");
  const auto read = must(parse_any(text, "cmm.csv", options));
  REQUIRE(read.set.readings.size() == 54);
  CHECK(says(read.set.notes, "set-up removed: shift X"));
  double largest = 0.0;
  for (const Reading& one : read.set.readings) largest = std::max(largest, std::abs(one.error));
  CHECK(largest < 2.0);  // of a scale of 3 um
  CHECK(largest > 1.0);
  options.keep_set_up = true;
  CHECK(must(parse_any(text, "cmm.csv", options)).set.readings[0].error == Approx(50.0));
  const auto lacks = parse_any(text, "cmm.csv", by_columns("x_mm=x,measured_y_mm=my"));
  CHECK(contains(lacks.error().message, "measured_y_mm needs y_mm"));
}
