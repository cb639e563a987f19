// The causes that a diagnosis leaves possible, each with its probability.
// Does not live here: how the diagnosis finds them (model/diagnosis/diagnose.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {

using model::SetMember;

/// The credible set that holds one named candidate, likeliest first; without the zeros of runs.
[[nodiscard]] std::vector<SetMember> credible_set_of(const model::Candidate& candidate);

/// The sets of all named candidates; empty where nothing is named.
[[nodiscard]] std::vector<SetMember> members_left(const model::Diagnosis& diagnosis);

/// Something is named, and no named cause has a rival.
[[nodiscard]] bool causes_are_single(const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
