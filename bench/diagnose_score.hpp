// Whether an answer is right, by the rules that `ecs model reveal` uses too (docs/model.md).
// Does not live here: the tables (diagnose_tally.hpp).
#pragma once

#include <string>
#include <vector>

#include "diagnose_case.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::bench {

/// The candidate is the hidden effect (approach and sensor included where the truth gives them), or lists it among
/// those that it cannot be distinguished from.
[[nodiscard]] bool matches(const model::Candidate& candidate, const HiddenEffect& truth);

[[nodiscard]] bool right(const Case& one, const model::Diagnosis& answer);

/// The rival names no group: right is the very effect first, none for a blank or foreign structure, both for a pair.
[[nodiscard]] bool rival_right(const Case& one, const std::vector<std::string>& names);

/// Scalar parameters that have a sigma, of named effects that stand alone; positions of steps excepted.
struct ParameterCount {
  unsigned counted = 0;
  unsigned within = 0;              ///< three sigmas
  std::vector<std::string> missed;  /// in words
};
[[nodiscard]] ParameterCount count_parameters(const Case& one, const model::Diagnosis& answer);

}  // namespace ecs::bench
