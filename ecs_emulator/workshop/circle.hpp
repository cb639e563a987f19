// A circular test on the machine (ISO 230-4): a ball bar between tool and table, contoured both ways. Does not live
// here: what the readings mean, the request (workshop.cpp).
#pragma once

#include <array>
#include <functional>

#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "laser/circle_test.hpp"

namespace ecs::emulator {

struct CirclePlan {
  std::array<Axis, 2> plane{Axis::X, Axis::Y};  ///< the angle rises from the first to the second
  Vector3 centre_mm{};                          ///< machine coordinates
  double radius_mm = 100.0;
  double feed_mm_min = 1000.0;
  double start_angle_deg = 0.0;
  double overlap_deg = 45.0;  ///< before and after each full turn, on the circle, not read
  double step_deg = 1.0;      ///< between readings
  int runs = 2;               ///< each of one turn counter-clockwise and one clockwise
  double noise_um = 0.1;      ///< standard deviation of the ball bar
};

/// The part program that is run: rapid to the circle, arcs in G02 and G03.
[[nodiscard]] std::string circle_program(const CirclePlan& plan);

/// Deviation = distance of the true tool point from the centre − radius, at the angle at which it truly is.
/// Problems: a plan that does not fit, a circle outside the travel (both `usage`), given up (`refused`).
/// @param report  after each block
[[nodiscard]] Result<laser::CircleTest> contour_circle(Simulation& simulation, const CirclePlan& plan,
                                                       const std::function<void()>& report = {});

}  // namespace ecs::emulator
