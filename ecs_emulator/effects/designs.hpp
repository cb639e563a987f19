// Designs of a measurement on which different effects do exactly the same; an effect says in which of them it can be
// hidden. Does not live here: how such a measurement is made (ecs_emulator/hidden_cases/confounded.cpp).
#pragma once

namespace ecs::emulator {

struct Design {
  enum Id : unsigned {
    kWarm = 1,       ///< positioning at one temperature of the material, not 20 °C
    kAir = 2,        ///< positioning in one air, not the reference air
    kWarmAir = 4,    ///< both
    kOneFeed = 8,    ///< both approaches at one feed
    kZero = 16,      ///< a zero in one air
    kSquare = 32,    ///< one axis in the direction of another
    kOneLever = 64,  ///< a rotation seen with one lever arm
    kCold = 128,     ///< positioning without temperatures
  };
};
using Designs = unsigned;  ///< of Design::Id, by |
inline constexpr Designs kNoDesign = 0;
inline constexpr Designs kEveryDesign = 255;

}  // namespace ecs::emulator
