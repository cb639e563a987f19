// A diagnosis as an answer: the verdict in one sentence, then the evidence.
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {

/// One sentence, plain.
[[nodiscard]] std::string verdict_sentence(const model::Diagnosis& diagnosis);

/// JSON as docs/verbs.md has it; text of 80 columns.
[[nodiscard]] Cell diagnosis_cell(const model::Diagnosis& diagnosis);
[[nodiscard]] std::string diagnosis_text(const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
