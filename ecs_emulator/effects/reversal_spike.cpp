// A transient after each reversal: c·d·e^(−u/u₀), u = travel since the reversal.
#include <cmath>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<double> decays_mm(const Scene&, const Ground&, const PlacedEffect&) {
  return {3.0, 8.0, 20.0, 50.0, 150.0, 500.0, 2000.0};
}

}  // namespace

extern const EffectDefinition kReversalSpike{
    .id = "reversal_spike",
    .parameters = {{.name = "c_um", .unit = "um", .growth = Growth::linear},
                   {.name = "u0_mm", .unit = "mm", .range = kPositive, .search = decays_mm}},
    .needs_axis = true,
    .own_axis_only = true,
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          return e.parameter("c_um") * at.approach * std::exp(-at.travel_since_reversal_mm / e.parameter("u0_mm"));
        },
    .needs = {.travel = true, .bidirectional = true},
    .places =
        [](const PlaceSearch& search) {
          return on_axes(search, [](const PlaceSearch& on, Sense s, Axis a) {
            return shows_approach(on, s, a) && on.scene.shown.travel;
          });
        },
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          const auto& places = places_under(drawing.ground, e);
          const double step_mm = (places.back() - places.front()) / static_cast<double>(places.size() - 1);
          e.parameters["c_um"] = 2.0 * drawing.sign;
          e.parameters["u0_mm"] = rounded(step_mm * between(drawing.random, 0.7, 3.0) + 3.0, 100.0);
          return true;
        },
};

}  // namespace ecs::emulator
