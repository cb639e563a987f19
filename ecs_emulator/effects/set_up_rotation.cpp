// An artefact set up turned by the angle c about an axis: in the plane XY (EC) EX −c·y, EY +c·x, and cyclically.
#include <algorithm>

#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

constexpr Axis next(Axis a) { return static_cast<Axis>((index_of(a) + 1) % kAxes); }
constexpr Sense translation_along(Axis a) { return static_cast<Sense>(index_of(a)); }

/// One of the two senses shows it; a good place is one in which both axes of the plane are measured against each other.
std::vector<PlacedEffect> planes(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const Axis about : kAllAxes) {
    const Axis one = next(about), other = next(one);
    const auto shows = [&](Axis sense, Axis cross) {
      const auto& senses = search.ground.senses;
      const Ground::Cover& cover = search.ground.cover(translation_along(sense), cross);
      return std::find(senses.begin(), senses.end(), translation_along(sense)) != senses.end() &&
             cover.places_mm.size() >= (search.good ? kFewTargets : 2) && (cover.moved || !search.good);
    };
    const bool first = shows(one, other), second = shows(other, one);
    if (search.good ? first && second : first || second)
      found.push_back(at_place(search.kind, {}, static_cast<Sense>(kAxes + index_of(about))));
  }
  return found;
}

/// The straightness of either axis of the plane in the direction of the other.
std::vector<PlacedEffect> two_slopes(const PlacedEffect& effect) {
  const Axis one = next(direction_of(*effect.sense)), other = next(one);
  PlacedEffect first = effect, second = effect;
  first.sense = translation_along(one);
  first.axis = other;
  first.parameters["um_per_m"] = -effect.parameter("um_per_m");
  second.sense = translation_along(other);
  second.axis = one;
  return {first, second};
}

}  // namespace

extern const EffectDefinition kSetUpRotation{
    .id = "set_up_rotation",
    .parameters = {{.name = "um_per_m", .unit = "um/m", .growth = Growth::linear}},
    .placed_by = PlacedBy::code_of_set_up,
    .value = [](const PlacedEffect& e, const Conditions& at) { return e.parameter("um_per_m") * (at.p_mm / kMmPerM); },
    .parts = two_slopes,
    .needs = {.translations = true, .least_axes = 2},
    .places = planes,
    .on_request = true,
};

}  // namespace ecs::emulator
