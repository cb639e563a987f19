// The design of one hidden case: machine, weather and the order of stops, drawn so that what shall be hidden can show.
// Does not live here: errors and readings.
#pragma once

#include <cstddef>

#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

/// A machine of one to three axes in any configuration.
[[nodiscard]] params::Machine draw_machine(Random& random, int least_axes);

/// @param readings  about so many
[[nodiscard]] Scene draw_scene(Random& random, const Needs& needs, std::size_t readings);

/// The geometry that follows from the machine.
void settle_geometry(Scene& scene);

/// One line of a measurement: an axis moves through its targets while the others are parked.
struct Line {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
};
/// How the lines are travelled.
struct Travel {
  PerAxis<std::vector<double>> targets_mm{};
  int runs = 3;
  bool bidirectional = true;
  bool backward_first = false;
  double dwell_s = 2.0;
  double pause_s = 60.0;                     ///< between runs
  std::vector<double> feeds_mm_min{2000.0};  ///< of the runs, in turn
  std::vector<double> loads_kg{0.0};
};
/// Stops in the order of time, run by run, line by line; the weather is not filled in.
[[nodiscard]] std::vector<Stop> stops_along(const std::vector<Line>& lines, const Travel& travel);

/// Sensors and weather for stops that have their times.
void draw_weather(Random& random, const Needs& needs, Scene& scene);

}  // namespace ecs::emulator
