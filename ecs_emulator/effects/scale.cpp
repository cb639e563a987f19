// A wrong scale: k·p.
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kScale{
    .id = "scale",
    .parameters = {{.name = "um_per_m", .unit = "um/m", .growth = Growth::linear}},
    .needs_axis = true,
    .value = [](const PlacedEffect& e, const Conditions& at) { return e.parameter("um_per_m") * (at.p_mm / kMmPerM); },
    .places = on_all_axes,
    .base_probability = 0.6,
    .confounded_in = Design::kWarm | Design::kAir | Design::kWarmAir | Design::kSquare | Design::kCold,
    .excluded_from = Design::kWarm | Design::kAir | Design::kWarmAir | Design::kSquare | Design::kCold,
};

}  // namespace ecs::emulator
