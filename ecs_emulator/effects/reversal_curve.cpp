// Lost motion that changes along the travel: s(p)·d/2, without mean and slope.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kReversalCurve{
    .id = "reversal_curve",
    .curve = CurveOf::shape,
    .needs_axis = true,
    .own_axis_only = true,
    .value = [](const PlacedEffect&, const Conditions& at) { return at.curve * at.approach / 2.0; },
    .needs = {.bidirectional = true},
    .places = [](const PlaceSearch& search) { return on_axes(search, shows_approach); },
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          draw_curve_without_line(drawing, e);
          return true;
        },
    .base_probability = 0.08,
    .line = "backlash",
    .excluded_from = Design::kOneFeed,
};

}  // namespace ecs::emulator
