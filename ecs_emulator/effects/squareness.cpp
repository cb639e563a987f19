// Two axes out of square, C0Y, B0Z, A0Z: a constant angle, seen through its lever arms.
#include <algorithm>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<PlacedEffect> squarenesses(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const Component code : {Component::C0Y, Component::B0Z, Component::A0Z}) {
    const auto shows = [&](Sense s) {
      return !is_rotation(s) && levers_mm(search.scene, search.ground, s, code).size() > 1;
    };
    if (std::any_of(search.ground.senses.begin(), search.ground.senses.end(), shows))
      found.push_back(at_place(search.kind, code == Component::C0Y ? Axis::Y : Axis::Z, {}, code));
  }
  return found;
}

}  // namespace

extern const EffectDefinition kSquareness{
    .id = "squareness",
    .parameters = {{.name = "um_per_m", .unit = "um/m", .growth = Growth::linear}},
    .placed_by = PlacedBy::code_of_squareness,
    .value = [](const PlacedEffect& e, const Conditions&) { return e.parameter("um_per_m"); },
    .needs = {.translations = true, .squares = true, .least_axes = 2},
    .places = squarenesses,
    .base_probability = 0.5,
    .confounded_in = Design::kSquare,
    .excluded_from = kEveryDesign,
};

}  // namespace ecs::emulator
