#include "ecs_emulator/effects/placed.hpp"

#include <cmath>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

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
