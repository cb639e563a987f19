// A constant: c.
#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/effects/places.hpp"

namespace ecs::emulator {

extern const EffectDefinition kOffset{
    .id = "offset",
    .parameters = {{.name = "um", .unit = "um", .growth = Growth::linear}},
    .value = [](const PlacedEffect& e, const Conditions&) { return e.parameter("um"); },
    .places = on_senses,
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          e.parameters["um"] = drawing.sign * 2.0;
          return true;
        },
    .in_every_base = true,
    .confounded_in = kZero,
    .excluded_from = kZero,
};

}  // namespace ecs::emulator
