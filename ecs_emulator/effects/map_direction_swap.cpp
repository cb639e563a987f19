// The unit has its tables for forward and reverse exchanged.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kMapDirectionSwap{
    .id = "map_direction_swap",
    .seat = Seat::unit,
    .elsewhere = kFaultOfTheMap,
    .spoil = [](const PlacedEffect&, MapReading& reading) { reading.approach = -reading.approach; },
    .needs = {.map = true, .one_axis = true, .bidirectional = true, .translations = true},
    .places =
        [](const PlaceSearch& search) {
          const auto& map = search.scene.map;
          const bool two_tables = !map.empty() && map.front().approach != Approach::unknown;
          return two_tables ? in_map(search) : std::vector<PlacedEffect>{};
        },
    .fixed_size = true,
};

}  // namespace ecs::emulator
