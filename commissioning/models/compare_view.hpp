// Where a model fails, as text of 80 columns and as JSON.
#pragma once

#include "base/json_fwd.hpp"
#include "model/fit/compare.hpp"

namespace ecs::commissioning {

[[nodiscard]] Cell comparison_cell(const model::Comparison& comparison, std::size_t readings);

}  // namespace ecs::commissioning
