// The answers of `ecs lengths fit` and `plan` as text and JSON. Only for .cpp files (heavy header).
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "commissioning/lengths/work.hpp"
#include "model/lengths/plan_lengths.hpp"

namespace ecs::commissioning {

/// Uncertainties are expanded (95 %). @param map, params_out  files that were written; empty: none
[[nodiscard]] Cell lengths_cell(const LengthsWork& work, const std::string& map, const std::string& params_out);
/// The answer of `ecs lengths plan`. @param file  that was written; empty: none
[[nodiscard]] Cell lengths_plan_cell(const model::LengthPlan& plan, double wanted_U_um, const std::string& file);

}  // namespace ecs::commissioning
