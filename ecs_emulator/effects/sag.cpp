// A ram that comes out and bends: k₂e² + k₃e³, e = |p|.
#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kSag{
    .id = "sag",
    .parameters = {{.name = "k2", .unit = "um/m^2", .growth = Growth::linear, .optional = true},
                   {.name = "k3", .unit = "um/m^3", .growth = Growth::linear, .optional = true}},
    .needs_axis = true,
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          const double extension_m = std::abs(at.p_mm) / kMmPerM;
          return (e.parameter("k2") + e.parameter("k3") * extension_m) * extension_m * extension_m;
        },
    .needs = {.translations = true},
    .places = on_all_axes,
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          const bool cubic = chance(drawing.random, 0.5);
          e.parameters["k2"] = drawing.sign;
          e.parameters["k3"] = 0.0;
          if (cubic) e.parameters["k3"] = sign_of_chance(drawing.random) * between(drawing.random, 0.2, 1.0);
          return true;
        },
    .explains_two = true,
    .base_probability = 0.08,
    .excluded_from = Design::kOneLever,
};

}  // namespace ecs::emulator
