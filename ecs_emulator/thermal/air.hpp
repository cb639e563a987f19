// The air between laser and retro-reflector at one instant.
// Does not live here: what it does to light (refraction), how it changes over the day (the machine's surroundings).
#pragma once

namespace ecs::emulator {

struct Air {
  double temperature_degC = 20.0;
  double pressure_hPa = 1013.25;
  double humidity_pct = 50.0;  ///< relative, over water
};

}  // namespace ecs::emulator
