#include <algorithm>

#include "ecs_emulator/hidden_cases/choice.hpp"

namespace ecs::emulator {
namespace {

constexpr std::size_t kFewTargets = 6;

void keep_each_once(std::vector<double>& places) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

bool along(Sense sense, Axis axis) { return static_cast<std::size_t>(sense) == index_of(axis); }

/// Coordinates of a lever that readings of the sense have, less the measurement line; each once.
std::vector<double> levers_mm(const Scene& scene, const Ground& ground, Sense sense, Component code) {
  std::vector<double> levers;
  for (const Term& term : scene.terms) {
    if (term.component != code || term.observed != direction_of(sense) || !term.uses_coordinate) continue;
    for (const double p : ground.cover(sense, term.lever).places_mm)
      levers.push_back(p + scene.datum_mm[index_of(term.lever)] -
                       (is_squareness(code) ? 0.0 : scene.lines_mm[index_of(moving_axis(code))][index_of(term.lever)]));
  }
  keep_each_once(levers);
  return levers;
}

/// Collects places; what is asked of all of them is said once.
class Places {
 public:
  Places(const Scene& scene, const Ground& ground, EffectKind kind, bool good)
      : scene_(scene), ground_(ground), kind_(kind), good_(good) {}

  std::vector<PlacedEffect> all() {
    if (is_map_fault(kind_))
      faults_of_map();
    else if (kind_ == EffectKind::angular)
      rotations();
    else if (kind_ == EffectKind::squareness)
      squareness();
    else if (kind_ == EffectKind::measurement_line)
      abbe();
    else
      for (const Sense s : ground_.senses) of_sense(s);
    return std::move(found_);
  }

 private:
  void add(std::optional<Axis> axis, std::optional<Sense> sense, std::optional<Component> code = {},
           const std::string& sensor = {}) {
    PlacedEffect effect;
    effect.kind = kind_;
    effect.axis = axis;
    effect.sense = sense;
    effect.code = code;
    effect.sensor = sensor;
    found_.push_back(effect);
  }

  void of_sense(Sense s) {
    const Axis natural = ground_.natural_axis(s);
    switch (kind_) {
      case EffectKind::time_drift:
        if (!scene_.shown.time) return;
        [[fallthrough]];
      case EffectKind::offset:
        return add(natural, s);
      case EffectKind::thermal_drift:
        for (const std::string& sensor : scene_.sensors)
          if (!good_ || (sensor != "t_air_degC" && sensor != "t_material_degC")) add(natural, s, {}, sensor);
        return;
      case EffectKind::dead_path:
        if (has_air() && along(s, natural)) add(natural, s);
        return;
      default:
        for (const Axis a : kAllAxes) of_sense_and_axis(s, a);
    }
  }

  void of_sense_and_axis(Sense s, Axis a) {
    const Ground::Cover& cover = ground_.cover(s, a);
    if (cover.places_mm.size() < 2 && kind_ != EffectKind::load && kind_ != EffectKind::warm_up) return;
    if (good_ && (!cover.moved || cover.places_mm.size() < kFewTargets)) return;
    const Shown& shown = scene_.shown;
    switch (kind_) {
      case EffectKind::thermal_scale:
        if (!scene_.sensor("t_material_degC") || (good_ && !along(s, a))) return;
        break;
      case EffectKind::air_refraction:
        if (!has_air() || !along(s, a)) return;
        break;
      case EffectKind::cosine:
        if (!along(s, a)) return;
        break;
      case EffectKind::warm_up:
        if (!shown.time || (cover.places_mm.size() < 2 && a != ground_.natural_axis(s))) return;
        break;
      case EffectKind::load:
        if (!shown.load || (cover.places_mm.size() < 2 && a != ground_.natural_axis(s))) return;
        break;
      case EffectKind::backlash:
      case EffectKind::reversal_curve:
        if (!cover.both_ways || !shown.approach) return;
        break;
      case EffectKind::servo_lag:
        if (!cover.both_ways || !shown.approach || !shown.feed) return;
        break;
      case EffectKind::reversal_spike:
        if (!cover.both_ways || !shown.approach || !shown.travel) return;
        break;
      default:
        break;
    }
    add(a, s);
  }

  void rotations() {
    for (const Axis b : kAllAxes) {
      if (!scene_.chain.has(b)) continue;
      for (const Sense r : {Sense::EA, Sense::EB, Sense::EC}) {
        const Component code = curve_of(r, b);
        for (const Sense s : ground_.senses) {
          if (is_rotation(s)) continue;
          const auto levers = levers_mm(scene_, ground_, s, code);
          const bool acts = levers.size() > 1 || (levers.size() == 1 && levers[0] != 0.0);
          const auto& cover = ground_.cover(s, b);
          if (good_ ? !(levers.size() > 1 && cover.moved && cover.places_mm.size() >= kFewTargets) : !acts) continue;
          add(b, {}, code);
          break;
        }
      }
    }
  }

  void squareness() {
    for (const Component code : {Component::C0Y, Component::B0Z, Component::A0Z})
      for (const Sense s : ground_.senses)
        if (!is_rotation(s) && levers_mm(scene_, ground_, s, code).size() > 1) {
          add(code == Component::C0Y ? Axis::Y : Axis::Z, {}, code);
          break;
        }
  }

  void abbe() {
    for (const KnownCurve& known : scene_.known)
      for (const Sense s : ground_.senses)
        if (!is_rotation(s) && ground_.cover(s, moving_axis(known.code)).moved)
          add(moving_axis(known.code), s, known.code);
  }

  /// The whole map, all of one axis, or one curve: each where it is not the same as a smaller part.
  void faults_of_map() {
    if (scene_.map.empty()) return;
    if (kind_ == EffectKind::map_direction_swap && scene_.map.front().approach == Approach::unknown) return;
    PerAxis<int> curves{};
    for (const UnitTable& table : scene_.map)
      if (table.approach != Approach::reverse) ++curves[index_of(table.axis)];
    int axes = 0;
    for (const Axis a : kAllAxes) {
      axes += curves[index_of(a)] > 0 ? 1 : 0;
      if (curves[index_of(a)] > (good_ ? 1 : 0)) add(a, {});
    }
    if (axes > (good_ ? 1 : 0)) add({}, {});
    for (const UnitTable& table : scene_.map)
      if (table.approach != Approach::reverse) add(table.axis, table.sense);
  }

  [[nodiscard]] bool has_air() const { return scene_.shown.air && scene_.sensor("t_air_degC"); }

  const Scene& scene_;
  const Ground& ground_;
  EffectKind kind_;
  bool good_;
  std::vector<PlacedEffect> found_;
};

}  // namespace

Axis Ground::natural_axis(Sense sense) const {
  int moved = 0;
  Axis only = direction_of(sense);
  for (const Axis a : kAllAxes)
    if (cover(sense, a).moved) {
      ++moved;
      only = a;
    }
  return moved == 1 ? only : direction_of(sense);
}

Ground ground_of(const Scene& scene) {
  Ground ground;
  std::array<std::array<int, 3>, 6> ways{};
  for (const Stop& stop : scene.stops) {
    const auto s = static_cast<std::size_t>(stop.sense);
    if (std::find(ground.senses.begin(), ground.senses.end(), stop.sense) == ground.senses.end())
      ground.senses.push_back(stop.sense);
    for (const Axis a : kAllAxes)
      if (scene.chain.has(a)) ground.covers[s][index_of(a)].places_mm.push_back(scene.p_mm(stop, a));
    ground.covers[s][index_of(stop.axis)].moved = true;
    ways[s][index_of(stop.axis)] |= stop.approach > 0 ? 1 : 2;
  }
  for (std::size_t s = 0; s < 6; ++s)
    for (std::size_t a = 0; a < 3; ++a) {
      keep_each_once(ground.covers[s][a].places_mm);
      ground.covers[s][a].both_ways = ways[s][a] == 3;
    }
  return ground;
}

std::vector<PlacedEffect> possible_places(const Scene& scene, const Ground& ground, EffectKind kind) {
  return Places(scene, ground, kind, false).all();
}

std::vector<PlacedEffect> good_places(const Scene& scene, const Ground& ground, EffectKind kind) {
  return Places(scene, ground, kind, true).all();
}

}  // namespace ecs::emulator
