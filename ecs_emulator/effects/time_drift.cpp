// A zero that creeps with time: c·t. In an errors file a fixture, in a hidden case the laser.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kTimeDrift{
    .id = "time_drift",
    .seat = Seat::instrument,
    .parameters = {{.name = "um_per_h", .unit = "um/h", .growth = Growth::linear}},
    .value = [](const PlacedEffect& e, const Conditions& at) { return e.parameter("um_per_h") * at.time_s / 3600.0; },
    .needs = {.time = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          return search.scene.shown.time ? on_senses(search) : std::vector<PlacedEffect>{};
        },
    .base_probability = 0.12,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
