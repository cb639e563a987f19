// Air that the laser does not correct, or not wholly: p·Δn (1: not at all).
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kAirRefraction{
    .id = "air_refraction",
    .seat = Seat::instrument,
    .parameters = {{.name = "factor", .unit = "1", .growth = Growth::linear, .range = {.above = 0.05, .below = 1.9}}},
    .elsewhere =
        "an effect of the instrument: the air is [air] of this file, what the laser makes of it "
        "air_compensation in [emulator.laser] of the machine file",
    .value = [](const PlacedEffect& e,
                const Conditions& at) { return e.parameter("factor") * at.p_mm * 1e3 * at.missing_refraction(); },
    .needs = {.temperature = true, .air = true, .along = true, .translations = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          return on_axes(search,
                         [](const PlaceSearch& on, Sense s, Axis a) { return shows_air(on) && is_along(s, a); });
        },
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          const bool whole = chance(drawing.random, 0.7);
          e.parameters["factor"] = whole ? 1.0 : rounded(between(drawing.random, 0.3, 1.2), 100.0);
          return true;
        },
    .natural_size = true,
    .confounded_in = Design::kAir | Design::kWarmAir,
};

}  // namespace ecs::emulator
