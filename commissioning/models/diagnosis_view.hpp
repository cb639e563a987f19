// A diagnosis as an answer, the headline, then the evidence; where a model fails.
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/compare.hpp"

namespace ecs::commissioning {

[[nodiscard]] Cell comparison_cell(const model::Comparison& comparison, std::size_t readings);

/// "< 0.5 %" where no replicate of noise looks as good, "3.2 %", "-" where it has no meaning: the effect alone explains
/// nothing that noise would not.
[[nodiscard]] std::string chance_text(const model::Candidate& candidate, const model::Diagnosis& diagnosis);

/// JSON as docs/verbs.md has it; text of 80 columns.
[[nodiscard]] Cell diagnosis_cell(const model::Diagnosis& diagnosis);
[[nodiscard]] std::string diagnosis_text(const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
