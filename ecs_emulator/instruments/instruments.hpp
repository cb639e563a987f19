// The kinds of instruments, one file each (instrument_*.cpp). Use set_up() of laser.hpp.
// Does not live here: what they have in common (laser.hpp).
#pragma once

#include "base/result.hpp"
#include "ecs_emulator/instruments/laser.hpp"

namespace ecs::emulator {

[[nodiscard]] std::unique_ptr<Instrument> linear_optics(Axis moving, const LaserSettings& settings);
[[nodiscard]] std::unique_ptr<Instrument> straightness_optics(Sense sense, const LaserSettings& settings,
                                                              Random& random);
[[nodiscard]] std::unique_ptr<Instrument> angular_optics(Sense sense, const LaserSettings& settings);
[[nodiscard]] std::unique_ptr<Instrument> electronic_level(Sense sense, const LaserSettings& settings);
[[nodiscard]] std::unique_ptr<Instrument> indicator_on_square(Sense sense, const LaserSettings& settings);

/// The error in that sense, um or um/m.
[[nodiscard]] inline double seen(const ToolPose& pose, Sense sense) {
  const std::size_t direction = index_of(direction_of(sense));
  return is_rotation(sense) ? pose.rotation_um_per_m[direction] : pose.error_um[direction];
}

/// A measurement that the machine or its instruments cannot make.
[[nodiscard]] inline tl::unexpected<Problem> refused(std::string message) {
  return problem(ProblemKind::usage, std::move(message));
}

}  // namespace ecs::emulator
