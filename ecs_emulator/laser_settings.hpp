// The instruments of the virtual workshop: the table `[emulator.laser]` of the machine file (docs/emulator.md).
// Does not live here: what they show (laser.hpp).
#pragma once

namespace ecs::emulator {

/// The instruments: standard deviations of one reading, resolutions, and how badly they are set up.
struct LaserSettings {
  double linear_noise_um = 0.1;
  double straightness_noise_um = 0.5;
  double angular_noise_um_per_m = 0.5;
  double level_noise_um_per_m = 1.0;
  double indicator_noise_um = 0.5;
  double linear_resolution_um = 0.01;
  double straightness_resolution_um = 0.1;
  double angular_resolution_um_per_m = 0.1;
  double level_resolution_um_per_m = 1.0;
  double indicator_resolution_um = 1.0;
  double setup_slope_um_per_m = 20.0;  ///< standard deviation of the slope between straight-edge and axis
  double setup_offset_um = 10.0;       ///< standard deviation
};

}  // namespace ecs::emulator
