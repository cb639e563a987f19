#include "ecs_emulator/effects/places.hpp"

#include <algorithm>

namespace ecs::emulator {

std::vector<PlacedEffect> possible_places(const Scene& scene, const Ground& ground, const EffectDefinition& kind) {
  return kind.places({kind, scene, ground, false});
}

std::vector<PlacedEffect> good_places(const Scene& scene, const Ground& ground, const EffectDefinition& kind) {
  return kind.places({kind, scene, ground, true});
}

PlacedEffect at_place(const EffectDefinition& kind, std::optional<Axis> axis, std::optional<Sense> sense,
                      std::optional<Component> code) {
  PlacedEffect effect;
  effect.kind = &kind;
  effect.axis = axis;
  effect.sense = sense;
  effect.code = code;
  return effect;
}

bool is_along(Sense sense, Axis axis) { return static_cast<std::size_t>(sense) == index_of(axis); }

bool shows_approach(const PlaceSearch& search, Sense sense, Axis axis) {
  return search.ground.cover(sense, axis).both_ways && search.scene.shown.approach;
}

bool shows_air(const PlaceSearch& search) { return search.scene.shown.air && search.scene.sensor("t_air_degC"); }

std::vector<PlacedEffect> on_axes(const PlaceSearch& search, Admits admits) {
  std::vector<PlacedEffect> found;
  for (const Sense s : search.ground.senses)
    for (const Axis a : kAllAxes) {
      const Ground::Cover& cover = search.ground.cover(s, a);
      if (cover.places_mm.size() < 2 || (search.good && (!cover.moved || cover.places_mm.size() < kFewTargets)))
        continue;
      if (admits(search, s, a)) found.push_back(at_place(search.kind, a, s));
    }
  return found;
}

std::vector<PlacedEffect> on_all_axes(const PlaceSearch& search) {
  return on_axes(search, [](const PlaceSearch&, Sense, Axis) { return true; });
}

std::vector<PlacedEffect> on_axes_or_parked(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const Sense s : search.ground.senses)
    for (const Axis a : kAllAxes) {
      const Ground::Cover& cover = search.ground.cover(s, a);
      if (search.good && (!cover.moved || cover.places_mm.size() < kFewTargets)) continue;
      if (cover.places_mm.size() >= 2 || a == search.ground.natural_axis(s))
        found.push_back(at_place(search.kind, a, s));
    }
  return found;
}

std::vector<PlacedEffect> on_senses(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  for (const Sense s : search.ground.senses) found.push_back(at_place(search.kind, search.ground.natural_axis(s), s));
  return found;
}

std::vector<PlacedEffect> in_map(const PlaceSearch& search) {
  std::vector<PlacedEffect> found;
  PerAxis<int> curves{};
  for (const UnitTable& table : search.scene.map)
    if (table.approach != Approach::reverse) ++curves[index_of(table.axis)];
  int axes = 0;
  for (const Axis a : kAllAxes) {
    axes += curves[index_of(a)] > 0 ? 1 : 0;
    if (curves[index_of(a)] > (search.good ? 1 : 0)) found.push_back(at_place(search.kind, a, {}));
  }
  if (axes > (search.good ? 1 : 0)) found.push_back(at_place(search.kind, {}, {}));
  for (const UnitTable& table : search.scene.map)
    if (table.approach != Approach::reverse) found.push_back(at_place(search.kind, table.axis, table.sense));
  return found;
}

std::vector<double> levers_mm(const Scene& scene, const Ground& ground, Sense sense, Component code) {
  std::vector<double> levers;
  for (const Term& term : scene.terms) {
    if (term.component != code || term.observed != direction_of(sense) || !term.uses_coordinate) continue;
    for (const double p : ground.cover(sense, term.lever).places_mm)
      levers.push_back(p + scene.datum_mm[index_of(term.lever)] -
                       (is_squareness(code) ? 0.0 : scene.lines_mm[index_of(moving_axis(code))][index_of(term.lever)]));
  }
  std::sort(levers.begin(), levers.end());
  levers.erase(std::unique(levers.begin(), levers.end()), levers.end());
  return levers;
}

}  // namespace ecs::emulator
