// The answer of `ecs lengths fit` as text and JSON. Only for .cpp files (heavy header).
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "commissioning/lengths/work.hpp"

namespace ecs::commissioning {

/// Uncertainties are expanded (k = 2). @param map, params_out  files that were written; empty: none
[[nodiscard]] Cell lengths_cell(const LengthsWork& work, const std::string& map, const std::string& params_out);

}  // namespace ecs::commissioning
