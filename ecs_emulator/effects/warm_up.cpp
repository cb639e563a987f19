// A machine that warms itself, without a sensor that sees it: (c + c₁·p)·(1 − e^(−t/τ)) (ISO 230-3:2020, 7).
#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<double> time_constants_s(const Scene& scene, const Ground&, const PlacedEffect&) {
  std::vector<double> values;
  for (const double part : {0.03, 0.08, 0.2, 0.4, 0.8, 2.0}) values.push_back(part * scene.stops.back().time_s);
  return values;
}

bool draw_warm_up(const Drawing& drawing, PlacedEffect& e) {
  Random& random = drawing.random;
  const double duration_s = drawing.scene.stops.back().time_s;
  e.parameters["tau_s"] = rounded(duration_s * between(random, 0.12, 0.45), 1.0);
  e.parameters["c_um"] = chance(random, 0.75) ? drawing.sign : 0.0;
  e.parameters["c_um_per_m"] = 0.0;
  if (e.parameters["c_um"] == 0.0 || chance(random, 0.3)) e.parameters["c_um_per_m"] = sign_of_chance(random) * 1.5;
  return true;
}

}  // namespace

extern const EffectDefinition kWarmUp{
    .id = "warm_up",
    .parameters = {{.name = "tau_s", .unit = "s", .range = kPositive, .search = time_constants_s},
                   {.name = "c_um", .unit = "um", .growth = Growth::linear, .optional = true},
                   {.name = "c_um_per_m", .unit = "um/m", .growth = Growth::linear, .optional = true}},
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          return (e.parameter("c_um") + e.parameter("c_um_per_m") * (at.p_mm / kMmPerM)) *
                 (1.0 - std::exp(-at.time_s / e.parameter("tau_s")));
        },
    .needs = {.time = true, .least_runs = 3},
    .places =
        [](const PlaceSearch& search) {
          return search.scene.shown.time ? on_axes_or_parked(search) : std::vector<PlacedEffect>{};
        },
    .draw = draw_warm_up,
    .base_probability = 0.03,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
