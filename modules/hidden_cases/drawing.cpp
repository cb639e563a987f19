// The drawing of effects from the table in hiding.cpp: their shapes, and what spans them.
#include <algorithm>
#include <cmath>

#include "modules/hidden_cases/places.hpp"

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

bool grows_with(const Hiding& hiding, std::string_view parameter) {
  return hiding.sizes.empty() || std::find(hiding.sizes.begin(), hiding.sizes.end(), parameter) != hiding.sizes.end();
}

constexpr std::size_t kCurveFunctions = 10;  ///< degrees of freedom of a smooth curve, mean and slope apart

std::vector<DrawnEffect> unit_curves(const Ground& ground, DrawnEffect unit) {
  std::vector<DrawnEffect> units;
  const auto& places = places_under(ground, unit);
  unit.curve = {places.front(), std::max(places.back(), places.front() + 1.0), 0.0, 0.0, {}};
  if (hiding_of(unit).mean_and_slope) {
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

bool Hiding::is_flexible() const { return search != nullptr || effect_named(id)->curve; }

const Hiding& hiding_of(const EffectDefinition& kind) {
  return hidings()[static_cast<std::size_t>(&kind - effects().data())];
}

const std::vector<const EffectDefinition*>& drawn_effects() {
  static const std::vector<const EffectDefinition*> kDrawn = [] {
    std::vector<const EffectDefinition*> drawn;
    for (const EffectDefinition& kind : effects())
      if (!hiding_of(kind).on_request) drawn.push_back(&kind);
    return drawn;
  }();
  return kDrawn;
}

DrawnEffect scaled(DrawnEffect effect, double factor) {
  const Hiding& hiding = hiding_of(effect);
  for (auto& [name, value] : effect.parameters)
    if (grows_with(hiding, name)) value *= hiding.square ? std::sqrt(std::abs(factor)) : factor;
  effect.curve.mean *= factor;
  effect.curve.slope *= factor;
  for (double& wave : effect.curve.waves) wave *= factor;
  return effect;
}

bool acts_on(const DrawnEffect& e, const Stop& stop) {
  const Hiding& hiding = hiding_of(e);
  if (e.sense && *e.sense != stop.sense) return false;
  if (hiding.seat != Seat::unit && (hiding.own_axis_only || e.approach != Approach::unknown) && *e.axis != stop.axis)
    return false;
  return e.approach == Approach::unknown || static_cast<int>(e.approach) == stop.approach;
}

std::optional<DrawnEffect> with_shape(Random& random, const Scene& scene, const Ground& ground, DrawnEffect effect) {
  const double sign = sign_of_chance(random);
  const Hiding& hiding = hiding_of(effect);
  if (hiding.draw != nullptr && !hiding.draw({random, scene, ground, sign}, effect)) return std::nullopt;
  if (hiding.draw == nullptr)
    for (const ParameterDefinition& parameter : effect.kind->parameters)
      effect.parameters[std::string(parameter.name)] = (hiding.square || hiding.unit_value ? 1.0 : sign) * hiding.drawn;
  return effect;
}

std::vector<DrawnEffect> unit_effects(const Ground& ground, const DrawnEffect& effect) {
  const Hiding& hiding = hiding_of(effect);
  if (hiding.seat == Seat::unit) return {effect};
  if (effect.kind->curve) return unit_curves(ground, effect);
  if (hiding.units != nullptr) return hiding.units(effect);
  std::vector<DrawnEffect> units;
  for (const ParameterDefinition& one : effect.kind->parameters) {
    if (!grows_with(hiding, one.name)) continue;
    units.push_back(effect);
    for (const ParameterDefinition& other : effect.kind->parameters)
      if (grows_with(hiding, other.name)) units.back().parameters[std::string(other.name)] = &other == &one ? 1.0 : 0.0;
  }
  return units;
}

std::vector<DrawnEffect> trials_of(const Scene& scene, const Ground& ground, DrawnEffect effect) {
  const Hiding& hiding = hiding_of(effect);
  if (hiding.unit_value) effect.parameters[std::string(effect.kind->parameters.front().name)] = *hiding.unit_value;
  if (hiding.search == nullptr) return {effect};
  std::vector<DrawnEffect> trials;
  for (const double value : hiding.search(scene, ground, effect)) {
    effect.parameters[std::string(hiding.searched)] = value;
    trials.push_back(effect);
  }
  return trials;
}

}  // namespace ecs::emulator
