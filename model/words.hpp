// Sentences about candidates: why one is named, and what would confirm it or separate it from its rivals.
#pragma once

#include <string>
#include <vector>

#include "model/diagnose.hpp"

namespace ecs::model {

/// @param rms_um  before the effect is added
[[nodiscard]] std::string reason_for(const Candidate& candidate, double rms_um, double noise_um,
                                     const Observations& data);

/// @param rivals  effects that these data cannot tell from it; empty: how to confirm it
[[nodiscard]] std::string separating_measurement(const EffectInstance& effect,
                                                 const std::vector<EffectInstance>& rivals, const Observations& data);

}  // namespace ecs::model
