// What is compared with: the automatic search of pointing software, on the same library.
#pragma once

#include <string>
#include <vector>

#include "model/data/observations.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::bench {

/// Ordinary least squares; the term that lowers BIC = n ln(Σr²/n) + k ln n most is added while it lowers it by 6 or
/// more. The names of the terms in the order in which they came.
[[nodiscard]] std::vector<std::string> stepwise_bic(const model::Model& model, const model::Observations& data);

}  // namespace ecs::bench
