// The effects of the library, a line each. A new effect is a file that defines it and a line in this list.
#include <algorithm>
#include <cassert>

#include "model/effects/definition.hpp"

// In the order in which lists of effects are printed; the effects of the user last.
#define ECS_EFFECTS(EFFECT)  \
  EFFECT(offset)             \
  EFFECT(scale)              \
  EFFECT(progressive)        \
  EFFECT(cyclic)             \
  EFFECT(backlash)           \
  EFFECT(reversal_curve)     \
  EFFECT(step)               \
  EFFECT(sag)                \
  EFFECT(angular)            \
  EFFECT(squareness)         \
  EFFECT(measurement_line)   \
  EFFECT(thermal_scale)      \
  EFFECT(thermal_drift)      \
  EFFECT(thermal_bend)       \
  EFFECT(set_up_rotation)    \
  EFFECT(warm_up)            \
  EFFECT(time_drift)         \
  EFFECT(air_refraction)     \
  EFFECT(dead_path)          \
  EFFECT(cosine)             \
  EFFECT(servo_lag)          \
  EFFECT(load)               \
  EFFECT(reversal_spike)     \
  EFFECT(map_polarity)       \
  EFFECT(map_gain)           \
  EFFECT(map_shift)          \
  EFFECT(map_direction_swap) \
  EFFECT(user)

namespace ecs::model {
namespace effects {

#define ECS_DECLARE(name) EffectDefinition name();
ECS_EFFECTS(ECS_DECLARE)
#undef ECS_DECLARE

}  // namespace effects

const std::vector<EffectDefinition>& effect_library() {
#define ECS_CALL(name) effects::name(),
  static const std::vector<EffectDefinition> library{ECS_EFFECTS(ECS_CALL)};
#undef ECS_CALL
  return library;
}

EffectId effect_named(std::string_view name) {
  for (const EffectDefinition& definition : effect_library())
    if (definition.id == name) return &definition;
  return nullptr;
}

EffectId effect_at(Place place) {
  const auto& library = effect_library();
  const auto found =
      std::find_if(library.begin(), library.end(), [&](const EffectDefinition& one) { return one.place == place; });
  assert(found != library.end());
  return &*found;
}

std::string_view EffectDefinition::searched_parameter() const {
  for (const ParameterDefinition& parameter : parameters)
    if (parameter.coding == Coding::searched) return parameter.name;
  return "";
}

}  // namespace ecs::model
