#include "ecs_emulator/effects/definition.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {
namespace {

/// Legendre polynomial of `degree` at `place` in −1 … 1, by Bonnet's recursion.
double legendre(std::size_t degree, double place) {
  double before = 1.0;
  double now = place;
  if (degree == 0) return before;
  for (std::size_t n = 1; n < degree; ++n) {
    const double k = static_cast<double>(n);
    const double next = ((2.0 * k + 1.0) * place * now - k * before) / (k + 1.0);
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

double value_at(const SmoothCurve& curve, double p_mm) {
  const double place = std::clamp(2.0 * (p_mm - curve.from_mm) / (curve.to_mm - curve.from_mm) - 1.0, -1.0, 1.0);
  double value = curve.mean + curve.slope * place;
  for (std::size_t k = 0; k < curve.waves.size(); ++k) value += curve.waves[k] * legendre(k + 2, place);
  return value;
}

/// Up to degree 5: nearer the ends a polynomial of higher degree turns faster than a curve of ten degrees of freedom.
SmoothCurve draw_curve(Random& random, const std::vector<double>& places_mm) {
  SmoothCurve curve;
  curve.from_mm = places_mm.front();
  curve.to_mm = places_mm.back();
  const int most = std::clamp(static_cast<int>(places_mm.size()) / 2 - 1, 1, 4);
  const int count = whole(random, std::min(2, most), most);
  const double roughness = between(random, 0.4, 1.2);
  for (int k = 0; k < count; ++k) curve.waves.push_back(random.normal() * std::pow(k + 1.0, -roughness));
  return curve;
}

double PlacedEffect::parameter(std::string_view name) const {
  const auto found = parameters.find(name);
  return found == parameters.end() ? 0.0 : found->second;
}

std::string name_of(const PlacedEffect& effect) {
  std::string text(effect.kind->id);
  if (effect.axis) text += std::string(":") + letter_of(*effect.axis);
  if (effect.code && effect.kind->placed_by != PlacedBy::sense) return text + ":" + std::string(name_of(*effect.code));
  if (effect.sense) text += ":" + std::string(name_of(*effect.sense));
  return text;
}

PlacedEffect scaled(PlacedEffect effect, double factor) {
  for (const ParameterDefinition& parameter : effect.kind->parameters) {
    const auto at = effect.parameters.find(parameter.name);
    if (at == effect.parameters.end()) continue;
    if (parameter.growth == Growth::linear) at->second *= factor;
    if (parameter.growth == Growth::square) at->second *= std::sqrt(std::abs(factor));
  }
  effect.curve.mean *= factor;
  effect.curve.slope *= factor;
  for (double& wave : effect.curve.waves) wave *= factor;
  return effect;
}

bool acts_on(const PlacedEffect& e, const Stop& stop) {
  if (e.sense && *e.sense != stop.sense) return false;
  if (e.kind->seat != Seat::unit && (e.kind->own_axis_only || e.approach != Approach::unknown) && *e.axis != stop.axis)
    return false;
  return e.approach == Approach::unknown || static_cast<int>(e.approach) == stop.approach;
}

std::vector<PlacedEffect> parts_of(const PlacedEffect& effect) {
  return effect.kind->parts == nullptr ? std::vector{effect} : effect.kind->parts(effect);
}

Component carrier_of(const PlacedEffect& effect) {
  const PlacedBy by = effect.kind->placed_by;
  const bool coded = by == PlacedBy::code_of_rotation || by == PlacedBy::code_of_squareness;
  return coded ? *effect.code : curve_of(*effect.sense, *effect.axis);
}

namespace {

constexpr std::size_t kCurveFunctions = 10;  ///< degrees of freedom of a smooth curve, mean and slope apart

std::vector<PlacedEffect> unit_curves(const Ground& ground, PlacedEffect unit) {
  std::vector<PlacedEffect> units;
  const auto& places = places_under(ground, unit);
  unit.curve = {places.front(), std::max(places.back(), places.front() + 1.0), 0.0, 0.0, {}};
  if (unit.kind->curve == CurveOf::shape_mean_and_slope) {
    unit.curve.mean = 1.0;
    units.push_back(unit);
    unit.curve.mean = 0.0;
    unit.curve.slope = 1.0;
    if (places.size() > 1) units.push_back(unit);
    unit.curve.slope = 0.0;
  }
  const std::size_t count = std::min(kCurveFunctions, places.size() > 2 ? places.size() - 2 : 0);
  for (std::size_t k = 0; k < count; ++k) {
    unit.curve.waves.assign(k + 1, 0.0);
    unit.curve.waves[k] = 1.0;
    units.push_back(unit);
  }
  return units;
}

}  // namespace

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

std::optional<PlacedEffect> with_shape(Random& random, const Scene& scene, const Ground& ground, PlacedEffect effect) {
  const double sign = sign_of_chance(random);
  const EffectDefinition& kind = *effect.kind;
  if (kind.draw != nullptr && !kind.draw({random, scene, ground, sign}, effect)) return std::nullopt;
  if (kind.draw == nullptr)
    for (const ParameterDefinition& parameter : kind.parameters)
      effect.parameters[std::string(parameter.name)] = sign * parameter.drawn;
  return effect;
}

std::vector<PlacedEffect> unit_effects(const Ground& ground, const PlacedEffect& effect) {
  const EffectDefinition& kind = *effect.kind;
  if (kind.seat == Seat::unit) return {effect};
  if (kind.curve != CurveOf::nothing) return unit_curves(ground, effect);
  if (kind.units != nullptr) return kind.units(effect);
  std::vector<PlacedEffect> units;
  for (const ParameterDefinition& one : kind.parameters) {
    if (one.growth == Growth::not_at_all) continue;
    PlacedEffect unit = effect;
    for (const ParameterDefinition& other : kind.parameters)
      if (other.growth != Growth::not_at_all) unit.parameters[std::string(other.name)] = &other == &one ? 1.0 : 0.0;
    units.push_back(std::move(unit));
  }
  return units;
}

std::vector<PlacedEffect> trials_of(const Scene& scene, const Ground& ground, PlacedEffect effect) {
  std::vector<PlacedEffect> trials;
  for (const ParameterDefinition& parameter : effect.kind->parameters) {
    if (parameter.search == nullptr && !parameter.unit_value) continue;
    const auto values =
        parameter.search != nullptr ? parameter.search(scene, ground, effect) : std::vector{*parameter.unit_value};
    for (const double value : values) {
      effect.parameters[std::string(parameter.name)] = value;
      trials.push_back(effect);
    }
    return trials;
  }
  return {effect};
}

bool is_flexible(const EffectDefinition& kind) {
  return kind.curve != CurveOf::nothing ||
         std::any_of(kind.parameters.begin(), kind.parameters.end(), [](const auto& p) { return p.search != nullptr; });
}

bool has_one_sign(const EffectDefinition& kind) {
  return std::any_of(kind.parameters.begin(), kind.parameters.end(),
                     [](const auto& p) { return p.growth == Growth::square; });
}

const std::vector<double>& places_under(const Ground& ground, const PlacedEffect& effect) {
  if (effect.sense) return ground.cover(*effect.sense, *effect.axis).places_mm;
  const std::vector<double>* most = &ground.cover(ground.senses.front(), *effect.axis).places_mm;
  for (const Sense s : ground.senses)
    if (ground.cover(s, *effect.axis).places_mm.size() > most->size()) most = &ground.cover(s, *effect.axis).places_mm;
  return *most;
}

void draw_curve_without_line(const Drawing& drawing, PlacedEffect& effect) {
  effect.curve = draw_curve(drawing.random, places_under(drawing.ground, effect));
  double n = 0.0, sx = 0.0, sxx = 0.0, sv = 0.0, sxv = 0.0;
  const double centre_mm = 0.5 * (effect.curve.from_mm + effect.curve.to_mm);
  const double half_mm = 0.5 * (effect.curve.to_mm - effect.curve.from_mm);
  for (const Stop& stop : drawing.scene.stops) {
    if (!acts_on(effect, stop)) continue;
    const double x = (drawing.scene.p_mm(stop, *effect.axis) - centre_mm) / half_mm;
    const double v = value_at(effect.curve, drawing.scene.p_mm(stop, *effect.axis));
    n += 1.0;
    sx += x;
    sxx += x * x;
    sv += v;
    sxv += x * v;
  }
  const double slope = (n * sxv - sx * sv) / (n * sxx - sx * sx);
  effect.curve.slope = -slope;
  effect.curve.mean = -(sv - slope * sx) / n;
}

}  // namespace ecs::emulator
