// Lengths from stations or along lines to the tool of the true machine, pose by pose as a plan says
// (modules/lengths/README.md). The poses are taken as reached: cold, unloaded, standing, without a unit; what the
// drives do on the way is not in it. Does not live here: what the lengths say of the machine: host and emulator share
// no code but the file format's words.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {

/// How good instrument and set-up are; standard deviations.
struct LengthInstrumentSettings {
  double noise_um = 0.2;        ///< of each reading
  double scale_um_per_m = 0.1;  ///< of each set-up: air, wavelength
  double station_mm = 0.2;      ///< of each coordinate of a station, from what the plan says
  double tool_mm = 0.05;        ///< of each coordinate of a tool, from what the plan says
  double zero_um = 100.0;       ///< of each run
  double bar_um = 1.0;          ///< of a ball bar's length, in place of the zeros, where the plan says `bar_um`
  bool scatter = true;          ///< of the machine
};

struct MeasuredLengths {
  std::string csv;
  std::size_t readings = 0;
};

/// The plan with a column deviation_um. Refused, all faults at once: a plan that lacks a column, names no tool or
/// set-up of its head, or goes beyond the travel.
[[nodiscard]] Result<MeasuredLengths> measured_lengths(Simulation& simulation, std::string_view plan,
                                                       const std::string& file,
                                                       const LengthInstrumentSettings& settings);

}  // namespace ecs::emulator
