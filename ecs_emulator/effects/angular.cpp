// A rotation of a carriage, EAX … ECZ, seen through its lever arms: ε(p)·L.
#include <algorithm>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

/// A lever that a single sense shows is enough; a good place has several levers, and targets enough.
bool shows(const PlaceSearch& search, Sense sense, Axis axis, Component code) {
  if (is_rotation(sense)) return false;
  const auto levers = levers_mm(search.scene, search.ground, sense, code);
  const auto& cover = search.ground.cover(sense, axis);
  if (search.good) return levers.size() > 1 && cover.moved && cover.places_mm.size() >= kFewTargets;
  return levers.size() > 1 || (levers.size() == 1 && levers[0] != 0.0);
}

std::vector<PlacedEffect> rotations(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const Axis a : kAllAxes) {
    if (!search.scene.chain.has(a)) continue;
    for (const Sense rotation : {Sense::EA, Sense::EB, Sense::EC}) {
      const Component code = curve_of(rotation, a);
      const auto& senses = search.ground.senses;
      if (std::any_of(senses.begin(), senses.end(), [&](Sense s) { return shows(search, s, a, code); }))
        found.push_back(at_place(search.kind, a, {}, code));
    }
  }
  return found;
}

}  // namespace

extern const EffectDefinition kAngular{
    .id = "angular",
    .curve = CurveOf::shape_mean_and_slope,
    .placed_by = PlacedBy::code_of_rotation,
    .value = [](const PlacedEffect&, const Conditions& at) { return at.curve; },
    .needs = {.translations = true, .levers = true, .least_axes = 2},
    .places = rotations,
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          e.curve = draw_curve(drawing.random, places_under(drawing.ground, e));
          e.curve.mean = drawing.random.normal();
          e.curve.slope = drawing.random.normal();
          return true;
        },
    .explains_two = true,
    .base_probability = 0.3,
    .confounded_in = Design::kOneLever,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
