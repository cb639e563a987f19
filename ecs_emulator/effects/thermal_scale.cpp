// Expansion of scale and workpiece: k·p·(T − 20 °C), T of the material.
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kThermalScale{
    .id = "thermal_scale",
    .parameters = {{.name = "um_per_m_degC", .unit = "um/(m degC)", .growth = Growth::linear}},
    .needs_axis = true,
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          return e.parameter("um_per_m_degC") * (at.p_mm / kMmPerM) * (at.material_degC() - 20.0);
        },
    .needs = {.temperature = true, .along = true, .translations = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          return on_axes(search, [](const PlaceSearch& on, Sense s, Axis a) {
            return on.scene.sensor("t_material_degC").has_value() && (!on.good || is_along(s, a));
          });
        },
    .base_probability = 0.4,
    .confounded_in = Design::kWarm | Design::kWarmAir,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
