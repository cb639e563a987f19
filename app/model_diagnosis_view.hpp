// A diagnosis as a person reads it, 80 columns: the verdict in one sentence, then the evidence.
// Does not live here: the diagnosis (model/diagnose.hpp), its JSON (model_json.hpp).
#pragma once

#include <string>

#include "model/diagnose.hpp"

namespace ecs::app {

/// One sentence, plain.
[[nodiscard]] std::string verdict_sentence(const model::Diagnosis& diagnosis);

[[nodiscard]] std::string diagnosis_text(const model::Diagnosis& diagnosis);

}  // namespace ecs::app
