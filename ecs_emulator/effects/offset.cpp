// A constant: c.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kOffset{
    .id = "offset",
    .parameters = {{.name = "um", .unit = "um", .growth = Growth::linear, .drawn = 2.0}},
    .value = [](const PlacedEffect& e, const Conditions&) { return e.parameter("um"); },
    .places = on_senses,
    .in_every_base = true,
    .confounded_in = Design::kZero,
    .excluded_from = Design::kZero,
};

}  // namespace ecs::emulator
