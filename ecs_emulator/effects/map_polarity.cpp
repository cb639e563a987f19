// The unit applies its map with the wrong sign: −2 × the map.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kMapPolarity{
    .id = "map_polarity",
    .seat = Seat::unit,
    .parameters = {{.name = "fraction", .unit = "1", .unit_value = 1.0}},
    .elsewhere = kFaultOfTheMap,
    .spoil = [](const PlacedEffect&, MapReading& reading) { reading.gain = -reading.gain; },
    .needs = {.map = true, .translations = true},
    .places = in_map,
    .draw =
        [](const Drawing&, PlacedEffect& e) {
          e.parameters["fraction"] = 1.0;
          return true;
        },
    .fixed_size = true,
};

}  // namespace ecs::emulator
