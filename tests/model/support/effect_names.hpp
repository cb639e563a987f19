// The effects of the library by the names that tests use.
#pragma once

#include "model/effects/definition.hpp"

namespace ecs::model::test::effects {

inline const EffectId offset = effect_named("offset");
inline const EffectId scale = effect_named("scale");
inline const EffectId progressive = effect_named("progressive");
inline const EffectId cyclic = effect_named("cyclic");
inline const EffectId backlash = effect_named("backlash");
inline const EffectId reversal_curve = effect_named("reversal_curve");
inline const EffectId step = effect_named("step");
inline const EffectId sag = effect_named("sag");
inline const EffectId angular = effect_named("angular");
inline const EffectId squareness = effect_named("squareness");
inline const EffectId measurement_line = effect_named("measurement_line");
inline const EffectId thermal_scale = effect_named("thermal_scale");
inline const EffectId thermal_drift = effect_named("thermal_drift");
inline const EffectId warm_up = effect_named("warm_up");
inline const EffectId time_drift = effect_named("time_drift");
inline const EffectId air_refraction = effect_named("air_refraction");
inline const EffectId dead_path = effect_named("dead_path");
inline const EffectId cosine = effect_named("cosine");
inline const EffectId servo_lag = effect_named("servo_lag");
inline const EffectId delay = effect_named("delay");
inline const EffectId load = effect_named("load");
inline const EffectId reversal_spike = effect_named("reversal_spike");
inline const EffectId friction = effect_named("friction");
inline const EffectId map_polarity = effect_named("map_polarity");
inline const EffectId map_gain = effect_named("map_gain");
inline const EffectId map_shift = effect_named("map_shift");
inline const EffectId map_direction_swap = effect_named("map_direction_swap");
inline const EffectId user = effect_named("user");

}  // namespace ecs::model::test::effects
