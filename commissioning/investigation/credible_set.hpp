// The causes that a diagnosis leaves possible, each with its probability.
// Does not live here: how the diagnosis finds them (model/diagnosis/diagnose.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {

using model::SetMember;

/// The credible set that holds one candidate, likeliest first; without the zeros of runs.
[[nodiscard]] std::vector<SetMember> credible_set_of(const model::Candidate& candidate);

/// The sets of all candidates of the answer, proved or likely; empty where it has none.
[[nodiscard]] std::vector<SetMember> members_left(const model::Diagnosis& diagnosis);

/// The answer has causes, and none has a rival.
[[nodiscard]] bool causes_are_single(const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
