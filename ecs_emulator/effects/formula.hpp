// What each effect that has its seat in the machine adds to its component (docs/surroundings.md).
// Does not live here: which component that is, when it acts (effect_errors.hpp,
// ecs_emulator/hidden_cases/contribution.hpp).
#pragma once

#include "ecs_emulator/effects/effect.hpp"

namespace ecs::emulator {

/// All that such an effect depends on.
struct EffectPoint {
  double p_mm = 0.0;      ///< of the effect's axis, from its datum
  double approach = 1.0;  ///< 1 or −1
  double curve = 0.0;     ///< value at p of the effect's curve, if it has one [um or um/m]
  double material_degC = 20.0;
  double sensor_rise_degC = 0.0;  ///< of the effect's sensor, since time 0
  double time_s = 0.0;
  double feed_mm_min = 0.0;
  double load_kg = 0.0;
  double travel_since_reversal_mm = 0.0;
};

/// Value of the component [um or um/m]; 0 for effects that do not sit in the machine.
[[nodiscard]] double machine_effect(const PlacedEffect& effect, const EffectPoint& at);

}  // namespace ecs::emulator
