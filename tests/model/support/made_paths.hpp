// Circles and diagonals of machines whose errors are given, for the tests of model/.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "base/random.hpp"
#include "laser/circle_test.hpp"
#include "laser/measurement_set.hpp"
#include "laser/standards/diagonals.hpp"
#include "model/data/path.hpp"

namespace ecs::model::test {

/// A place of a path, with the signs of motion of the axes.
struct PathPlace {
  Vector3 position_mm{};
  std::array<int, kAxes> motion{};
};
/// Errors of the three directions there [um].
using MachineErrors = std::function<Vector3(const PathPlace&)>;

struct CircleMade {
  double radius_mm = 100.0;
  int readings = 180;
  int runs = 2;
  double noise_um = 0.2;
  Vector3 centre_mm{400.0, 300.0, 0.0};
  std::array<Axis, 2> plane{Axis::X, Axis::Y};
  unsigned seed = 1;
};

/// With centre and radius off by some um, as any set-up has them.
inline laser::CircleTest made_circle(const MachineErrors& errors, const CircleMade& made = {}) {
  std::mt19937_64 random(made.seed);
  NormalDraws normal;
  laser::CircleTest test{
      .source = "circle.csv", .plane = made.plane, .radius_mm = made.radius_mm, .feed_mm_min = 2000.0};
  const std::size_t u = index_of(made.plane[0]), v = index_of(made.plane[1]);
  test.centre_mm = {made.centre_mm[u], made.centre_mm[v]};
  for (int run = 1; run <= made.runs; ++run)
    for (const bool clockwise : {false, true})
      for (int i = 0; i < made.readings; ++i) {
        const double angle_deg = 360.0 * (i + 0.3) / made.readings, angle = angle_deg * std::numbers::pi / 180.0;
        const double c = std::cos(angle), s = std::sin(angle), sense = clockwise ? -1.0 : 1.0;
        PathPlace place{made.centre_mm, {}};
        place.position_mm[u] += made.radius_mm * c;
        place.position_mm[v] += made.radius_mm * s;
        place.motion[u] = -s * sense > 0.0 ? 1 : -1;
        place.motion[v] = c * sense > 0.0 ? 1 : -1;
        const Vector3 e = errors(place);
        const double deviation_um =
            3.0 + run + 5.0 * c - 4.0 * s + e[u] * c + e[v] * s + made.noise_um * normal(random);
        test.readings.push_back({0, angle_deg, deviation_um, clockwise, run});
      }
  return test;
}

/// The four diagonals of a body of 800 by 500 by 400 mm, eleven places, both ways, each run with a zero of its own.
inline laser::MeasurementSet made_diagonals(const MachineErrors& errors, double noise_um, int runs = 3,
                                            unsigned seed = 1) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  constexpr Vector3 kSpan_mm{800.0, 500.0, 400.0};
  laser::DiagonalTest test{.source = "diagonals.csv", .span_mm = kSpan_mm};
  for (const char* key : {"from_x_mm", "from_y_mm", "from_z_mm"}) test.metadata.push_back({key, "0"});
  const double length_mm = std::hypot(kSpan_mm[0], kSpan_mm[1], kSpan_mm[2]);
  for (const laser::DiagonalDirection& direction :
       {laser::DiagonalDirection{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}) {
    laser::DiagonalReadings diagonal;
    for (const int sign : direction) diagonal.name += sign > 0 ? 'P' : 'N';
    diagonal.direction = direction;
    for (int run = 1; run <= runs; ++run)
      for (const int approach : {1, -1})
        for (int i = 0; i <= 10; ++i) {
          const double share = 0.1 * (approach > 0 ? i : 10 - i);
          PathPlace place;
          double along_um = 7.0 * run + noise_um * normal(random);
          Vector3 unit{};
          for (std::size_t a = 0; a < kAxes; ++a) {
            unit[a] = direction[a] * kSpan_mm[a] / length_mm;
            place.position_mm[a] = direction[a] > 0 ? share * kSpan_mm[a] : (1.0 - share) * kSpan_mm[a];
            place.motion[a] = direction[a] * approach;
          }
          const Vector3 e = errors(place);
          for (std::size_t a = 0; a < kAxes; ++a) along_um += unit[a] * e[a];
          laser::Reading reading;
          reading.position_mm[0] = share * length_mm;
          reading.error = along_um;
          reading.approach = static_cast<Approach>(approach);
          reading.run = run;
          diagonal.readings.readings.push_back(reading);
        }
    test.diagonals.push_back(std::move(diagonal));
  }
  return set_of_diagonals(test).value();
}

}  // namespace ecs::model::test
