// Sentences about candidates: why one is named, and what would confirm it or separate it from its rivals.
// Does not live here: the numbers in them (diagnose.hpp), the run that separates best (model/planning/).
#pragma once

#include <string>
#include <vector>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::model {

/// A share times this is in per cent.
inline constexpr double kPercent = 100.0;

/// @param diagnosis  with rms, noise and the number of noise replicates
[[nodiscard]] std::string reason_for(const Candidate& candidate, const Diagnosis& diagnosis, const Observations& data);

/// @param rivals  effects that these data cannot tell from it; empty: how to confirm it
[[nodiscard]] std::string separating_measurement(const EffectInstance& effect,
                                                 const std::vector<EffectInstance>& rivals);

}  // namespace ecs::model
