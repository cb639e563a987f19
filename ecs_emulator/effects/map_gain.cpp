// The unit applies its map too large or too small: (g − 1) × the map.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kMapGain{
    .id = "map_gain",
    .seat = Seat::unit,
    .parameters = {{.name = "gain", .unit = "1", .unit_value = 2.0}},
    .elsewhere = kFaultOfTheMap,
    .spoil = [](const PlacedEffect& e, MapReading& reading) { reading.gain *= e.parameter("gain"); },
    .needs = {.map = true, .translations = true},
    .places = in_map,
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          e.parameters["gain"] = one(drawing.random, std::vector{0.0, 0.5, 0.8, 1.25, 1.5, 2.0, 10.0});
          return true;
        },
};

}  // namespace ecs::emulator
