// A machine that yields under the workpiece: (c + c₁·p)·m.
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kLoad{
    .id = "load",
    .parameters = {{.name = "um_per_kg", .unit = "um/kg", .growth = Growth::linear, .optional = true},
                   {.name = "um_per_kg_m", .unit = "um/(kg m)", .growth = Growth::linear, .optional = true}},
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          return at.load_kg * (e.parameter("um_per_kg") + e.parameter("um_per_kg_m") * (at.p_mm / kMmPerM));
        },
    .needs = {.loads = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          return search.scene.shown.load ? on_axes_or_parked(search) : std::vector<PlacedEffect>{};
        },
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          const bool tilts = chance(drawing.random, 0.5);
          e.parameters["um_per_kg"] = drawing.sign * 0.01;
          e.parameters["um_per_kg_m"] = tilts ? sign_of_chance(drawing.random) * 0.01 : 0.0;
          return true;
        },
    .base_probability = 0.15,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
