#include "modules/hidden_cases/places.hpp"

#include <algorithm>

namespace ecs::emulator {
namespace {

/// Fewer targets do not show a curve or a slope.
constexpr std::size_t kFewTargets = 6;

/// Coordinates of a lever that readings of the sense have, less the measurement line; ascending, each once.
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

/// A lever that a single sense shows is enough; a good place has several levers, and targets enough.
bool shows(const PlaceSearch& search, Sense sense, Axis axis, Component code) {
  if (is_rotation(sense)) return false;
  const auto levers = levers_mm(search.scene, search.ground, sense, code);
  const auto& cover = search.ground.cover(sense, axis);
  if (search.good) return levers.size() > 1 && cover.moved && cover.places_mm.size() >= kFewTargets;
  return levers.size() > 1 || (levers.size() == 1 && levers[0] != 0.0);
}

/// Every axis in every sense, where it has places enough and admits the effect.
std::vector<DrawnEffect> on_axes(const PlaceSearch& search) {
  const auto admits = hiding_of(search.kind).admits;
  std::vector<DrawnEffect> found;
  for (const Sense s : search.ground.senses)
    for (const Axis a : kAllAxes) {
      const Ground::Cover& cover = search.ground.cover(s, a);
      if (cover.places_mm.size() < 2 || (search.good && (!cover.moved || cover.places_mm.size() < kFewTargets)))
        continue;
      if (admits == nullptr || admits(search, s, a)) found.push_back(at_place(search.kind, a, s));
    }
  return found;
}

}  // namespace

const std::vector<double>& places_under(const Ground& ground, const DrawnEffect& effect) {
  if (effect.sense) return ground.cover(*effect.sense, *effect.axis).places_mm;
  const std::vector<double>* most = &ground.cover(ground.senses.front(), *effect.axis).places_mm;
  for (const Sense s : ground.senses)
    if (ground.cover(s, *effect.axis).places_mm.size() > most->size()) most = &ground.cover(s, *effect.axis).places_mm;
  return *most;
}

bool is_along(Sense sense, Axis axis) { return sense == translation_along(axis); }
bool shows_air(const PlaceSearch& search) { return search.scene.shown.air && search.scene.sensor("t_air_degC"); }

bool shows_approach(const PlaceSearch& search, Sense sense, Axis axis) {
  return search.ground.cover(sense, axis).both_ways && search.scene.shown.approach;
}

std::vector<DrawnEffect> on_axes_or_parked(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  for (const Sense s : search.ground.senses)
    for (const Axis a : kAllAxes) {
      const Ground::Cover& cover = search.ground.cover(s, a);
      if (search.good && (!cover.moved || cover.places_mm.size() < kFewTargets)) continue;
      if (cover.places_mm.size() >= 2 || a == search.ground.natural_axis(s))
        found.push_back(at_place(search.kind, a, s));
    }
  return found;
}

std::vector<DrawnEffect> on_senses(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  for (const Sense s : search.ground.senses) found.push_back(at_place(search.kind, search.ground.natural_axis(s), s));
  return found;
}

std::vector<DrawnEffect> in_map(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
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

std::vector<DrawnEffect> rotations(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
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

std::vector<DrawnEffect> squarenesses(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  for (const Component code : {Component::C0Y, Component::B0Z, Component::A0Z}) {
    const auto shows = [&](Sense s) {
      return !is_rotation(s) && levers_mm(search.scene, search.ground, s, code).size() > 1;
    };
    if (std::any_of(search.ground.senses.begin(), search.ground.senses.end(), shows))
      found.push_back(at_place(search.kind, code == Component::C0Y ? Axis::Y : Axis::Z, {}, code));
  }
  return found;
}

std::vector<DrawnEffect> planes(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  for (const Axis about : kAllAxes) {
    const auto one = static_cast<Axis>((index_of(about) + 1) % kAxes);
    const auto other = static_cast<Axis>((index_of(about) + 2) % kAxes);
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

std::vector<DrawnEffect> pairs_of_sensors(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  const auto& sensors = search.scene.sensors;
  const std::size_t first = search.good && !sensors.empty() && sensors.front() == "t_air_degC" ? 1 : 0;
  for (const DrawnEffect& place : on_axes(search))
    for (std::size_t i = first; i < sensors.size(); ++i)
      for (std::size_t k = i + 1; k < sensors.size(); ++k) {
        found.push_back(place);
        found.back().sensor = sensors[i];
        found.back().sensor2 = sensors[k];
      }
  return found;
}

std::vector<DrawnEffect> sensors_of_senses(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  for (const DrawnEffect& place : on_senses(search))
    for (const std::string& sensor : search.scene.sensors) {
      if (search.good && (sensor == "t_air_degC" || sensor == "t_material_degC")) continue;
      found.push_back(place);
      found.back().sensor = sensor;
    }
  return found;
}

std::vector<DrawnEffect> lines_of_known(const PlaceSearch& search) {
  std::vector<DrawnEffect> found;
  for (const KnownCurve& known : search.scene.known)
    for (const Sense s : search.ground.senses)
      if (!is_rotation(s) && search.ground.cover(s, moving_axis(known.code)).moved)
        found.push_back(at_place(search.kind, moving_axis(known.code), s, known.code));
  return found;
}

std::vector<DrawnEffect> places_of(const EffectDefinition& kind, const Scene& scene, const Ground& ground, bool good) {
  const auto places = hiding_of(kind).places;
  const PlaceSearch search{kind, scene, ground, good};
  return places == nullptr ? on_axes(search) : places(search);
}

DrawnEffect at_place(const EffectDefinition& kind, std::optional<Axis> axis, std::optional<Sense> sense,
                     std::optional<Component> code) {
  DrawnEffect effect;
  effect.kind = &kind;
  effect.axis = axis;
  effect.sense = sense;
  effect.code = code;
  return effect;
}

}  // namespace ecs::emulator
