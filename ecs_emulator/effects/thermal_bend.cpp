// A column or bed that bends because one side is warmer than the other: c·p²·(T₁ − T₂), across the axis. A temperature
// that changes linearly over the height h bends it with the curvature α·ΔT/h, so that c = α/(2h).
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

/// Straightness of an axis that moves, by each pair of sensors; a good pair are two bodies of the machine.
std::vector<PlacedEffect> pairs_of_sensors(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  const auto& sensors = search.scene.sensors;
  const std::size_t first = search.good && !sensors.empty() && sensors.front() == "t_air_degC" ? 1 : 0;
  for (const PlacedEffect& place :
       on_axes(search, [](const PlaceSearch&, Sense s, Axis a) { return !is_rotation(s) && !is_along(s, a); }))
    for (std::size_t i = first; i < sensors.size(); ++i)
      for (std::size_t k = i + 1; k < sensors.size(); ++k) {
        found.push_back(place);
        found.back().sensor = sensors[i];
        found.back().sensor2 = sensors[k];
      }
  return found;
}

}  // namespace

extern const EffectDefinition kThermalBend{
    .id = "thermal_bend",
    .parameters = {{.name = "um_per_m2_degC", .unit = "um/(m^2 degC)", .growth = Growth::linear}},
    .sensors = 2,
    .needs_axis = true,
    .straightness = true,
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          const double p_m = at.p_mm / kMmPerM;
          return e.parameter("um_per_m2_degC") * p_m * p_m * (at.degC(e.sensor) - at.degC(e.sensor2));
        },
    .needs = {.temperature = true, .translations = true, .least_runs = 3},
    .places = pairs_of_sensors,
    .on_request = true,
};

}  // namespace ecs::emulator
