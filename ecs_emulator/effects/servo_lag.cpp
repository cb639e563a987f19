// A drive that stays behind by its feed: c·feed·d.
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kServoLag{
    .id = "servo_lag",
    .parameters = {{.name = "um_per_m_min", .unit = "um/(m/min)", .growth = Growth::linear}},
    .needs_axis = true,
    .own_axis_only = true,
    .value = [](const PlacedEffect& e,
                const Conditions& at) { return e.parameter("um_per_m_min") * at.feed_mm_min / kMmPerM * at.approach; },
    .needs = {.feeds = true, .bidirectional = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          return on_axes(search, [](const PlaceSearch& on, Sense s, Axis a) {
            return shows_approach(on, s, a) && on.scene.shown.feed;
          });
        },
    .base_probability = 0.1,
    .confounded_in = Design::kOneFeed,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
