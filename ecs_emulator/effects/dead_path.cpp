// Air between interferometer and reflector at zero that is not corrected: L·Δn.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kDeadPath{
    .id = "dead_path",
    .seat = Seat::instrument,
    .parameters = {{.name = "length_m", .unit = "m", .growth = Growth::linear, .range = {.above = 0.02, .below = 9.5}}},
    .elsewhere = "an effect of the instrument: set dead_path_m in [emulator.laser] of the machine file",
    .value = [](const PlacedEffect& e,
                const Conditions& at) { return e.parameter("length_m") * 1e6 * at.missing_refraction(); },
    .needs = {.temperature = true, .air = true, .along = true, .translations = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          auto found = shows_air(search) ? on_senses(search) : std::vector<PlacedEffect>{};
          std::erase_if(found, [](const PlacedEffect& place) { return !is_along(*place.sense, *place.axis); });
          return found;
        },
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          e.parameters["length_m"] = rounded(log_between(drawing.random, 0.2, 5.0), 1000.0);
          return true;
        },
    .natural_size = true,
    .confounded_in = Design::kZero,
};

}  // namespace ecs::emulator
