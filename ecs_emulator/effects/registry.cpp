#include <algorithm>
#include <array>

#include "ecs_emulator/effects/definition.hpp"

/// One line an effect: the definition of that name, in the file of its id.
#define ECS_EMULATOR_EFFECTS(EFFECT) \
  EFFECT(kOffset)                    \
  EFFECT(kScale)                     \
  EFFECT(kProgressive)               \
  EFFECT(kCyclic)                    \
  EFFECT(kBacklash)                  \
  EFFECT(kReversalCurve)             \
  EFFECT(kStep)                      \
  EFFECT(kSag)                       \
  EFFECT(kAngular)                   \
  EFFECT(kSquareness)                \
  EFFECT(kMeasurementLine)           \
  EFFECT(kThermalScale)              \
  EFFECT(kThermalDrift)              \
  EFFECT(kWarmUp)                    \
  EFFECT(kTimeDrift)                 \
  EFFECT(kAirRefraction)             \
  EFFECT(kDeadPath)                  \
  EFFECT(kCosine)                    \
  EFFECT(kServoLag)                  \
  EFFECT(kLoad)                      \
  EFFECT(kReversalSpike)             \
  EFFECT(kMapPolarity)               \
  EFFECT(kMapGain)                   \
  EFFECT(kMapShift)                  \
  EFFECT(kMapDirectionSwap)          \
  EFFECT(kThermalBend)               \
  EFFECT(kSetUpRotation)

namespace ecs::emulator {

#define EFFECT(name) extern const EffectDefinition name;
ECS_EMULATOR_EFFECTS(EFFECT)
#undef EFFECT

std::span<const EffectDefinition* const> effects() {
#define EFFECT(name) &name,
  static constexpr std::array kAll{ECS_EMULATOR_EFFECTS(EFFECT)};
#undef EFFECT
  return kAll;
}

const std::vector<const EffectDefinition*>& drawn_effects() {
  static const std::vector<const EffectDefinition*> kDrawn = [] {
    std::vector<const EffectDefinition*> drawn;
    std::copy_if(effects().begin(), effects().end(), std::back_inserter(drawn),
                 [](const EffectDefinition* effect) { return !effect->on_request; });
    return drawn;
  }();
  return kDrawn;
}

const EffectDefinition* effect_named(std::string_view id) {
  const auto found = std::find_if(effects().begin(), effects().end(),
                                  [id](const EffectDefinition* effect) { return effect->id == id; });
  return found == effects().end() ? nullptr : *found;
}

}  // namespace ecs::emulator
