// Lost motion: b·d/2, of the axis that moves.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kBacklash{
    .id = "backlash",
    .parameters = {{.name = "um", .unit = "um", .growth = Growth::linear, .drawn = 2.0}},
    .needs_axis = true,
    .own_axis_only = true,
    .value = [](const PlacedEffect& e, const Conditions& at) { return e.parameter("um") * at.approach / 2.0; },
    .needs = {.bidirectional = true},
    .places = [](const PlaceSearch& search) { return on_axes(search, shows_approach); },
    .base_probability = 0.4,
    .confounded_in = Design::kOneFeed,
    .excluded_from = Design::kOneFeed,
};

}  // namespace ecs::emulator
