#include "ecs_emulator/effects/definition.hpp"

#include <algorithm>
#include <cmath>

#include "ecs_emulator/random/random.hpp"

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

}  // namespace ecs::emulator
