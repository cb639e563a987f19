// Where a model fails, as text of 80 columns and as JSON. Only for .cpp files (heavy header).
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "model/fit/compare.hpp"

namespace ecs::commissioning {

[[nodiscard]] std::string comparison_text(const model::Comparison& comparison, std::size_t readings);
[[nodiscard]] Json json_of(const model::Comparison& comparison);

}  // namespace ecs::commissioning
