// A diagnosis as a person reads it, 80 columns: the verdict in one sentence, then the evidence.
#pragma once

#include <string>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {

/// One sentence, plain.
[[nodiscard]] std::string verdict_sentence(const model::Diagnosis& diagnosis);

[[nodiscard]] std::string diagnosis_text(const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
