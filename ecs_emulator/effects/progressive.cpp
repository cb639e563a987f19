// A smooth curve over the travel, without mean and slope: s(p).
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kProgressive{
    .id = "progressive",
    .curve = CurveOf::shape,
    .needs_axis = true,
    .value = [](const PlacedEffect&, const Conditions& at) { return at.curve; },
    .places = on_all_axes,
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          draw_curve_without_line(drawing, e);
          return true;
        },
    .base_probability = 0.35,
    .line = "scale",
    .confounded_in = Design::kOneLever,
    .excluded_from = Design::kOneLever,
};

}  // namespace ecs::emulator
