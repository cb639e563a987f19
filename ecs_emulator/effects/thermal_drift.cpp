// A zero that follows a temperature of the machine: c·(T − T₀), T₀ at time 0.
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<PlacedEffect> sensors_of_senses(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const PlacedEffect& place : on_senses(search))
    for (const std::string& sensor : search.scene.sensors) {
      if (search.good && (sensor == "t_air_degC" || sensor == "t_material_degC")) continue;
      found.push_back(place);
      found.back().sensor = sensor;
    }
  return found;
}

}  // namespace

extern const EffectDefinition kThermalDrift{
    .id = "thermal_drift",
    .parameters = {{.name = "um_per_degC", .unit = "um/degC", .growth = Growth::linear}},
    .sensors = 1,
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          return e.parameter("um_per_degC") * (at.degC(e.sensor) - at.first_degC(e.sensor));
        },
    .needs = {.temperature = true, .least_runs = 3},
    .places = sensors_of_senses,
    .base_probability = 0.1,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
