// A beam at an angle to the axis: −p·φ²/2, always short.
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

extern const EffectDefinition kCosine{
    .id = "cosine",
    .seat = Seat::instrument,
    .parameters = {{.name = "angle_mrad", .unit = "mrad", .growth = Growth::square}},
    .elsewhere = "an effect of the instrument: set misalignment_mrad in [emulator.laser] of the machine file",
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          return -at.p_mm / kMmPerM * e.parameter("angle_mrad") * e.parameter("angle_mrad") / 2.0;
        },
    .needs = {.along = true, .translations = true},
    .places =
        [](const PlaceSearch& search) {
          return on_axes(search, [](const PlaceSearch&, Sense s, Axis a) { return is_along(s, a); });
        },
    .draw =
        [](const Drawing&, PlacedEffect& e) {
          e.parameters["angle_mrad"] = 1.5;
          return true;
        },
    .confounded_in = Design::kWarm | Design::kAir | Design::kWarmAir | Design::kCold,
};

}  // namespace ecs::emulator
