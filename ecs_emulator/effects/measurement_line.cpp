// A map measured on another line than it is used on: lever × a component measured separately (Abbe).
#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<PlacedEffect> lines_of_known(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const KnownCurve& known : search.scene.known)
    for (const Sense s : search.ground.senses)
      if (!is_rotation(s) && search.ground.cover(s, moving_axis(known.code)).moved)
        found.push_back(at_place(search.kind, moving_axis(known.code), s, known.code));
  return found;
}

}  // namespace

extern const EffectDefinition kMeasurementLine{
    .id = "measurement_line",
    .parameters = {{.name = "lever_mm", .unit = "mm", .growth = Growth::linear, .drawn = 300.0}},
    .elsewhere =
        "comes from where the map was measured, not from the machine: measure with the other axes parked "
        "elsewhere (parked_mm of the plan)",
    .value = [](const PlacedEffect& e,
                const Conditions& at) { return e.parameter("lever_mm") / kMmPerM * at.known_value(); },
    .needs = {.known = true, .translations = true},
    .places = lines_of_known,
    .base_probability = 0.3,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
