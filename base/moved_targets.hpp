// Target positions moved off an even grid: on even targets a period looks like others of its (aliases), on moved ones
// not (ISO 230-2:2014, 5.2: p_i = (i − 1)·p + r, r another for each target; here the first and the last stay).
#pragma once

#include <optional>
#include <vector>

namespace ecs {

/// Step [mm] of the even grid that holds all targets, within a fiftieth of it; nothing for fewer than three targets or
/// uneven ones. The last digit with which uneven targets are written is no such grid.
/// @param targets_mm  in any order; equal ones count once
[[nodiscard]] std::optional<double> even_step_mm(std::vector<double> targets_mm);

/// Each target but the first and the last moved by up to 0.3 of the shorter way to its neighbours, in whole
/// micrometres; the same targets give the same again.
/// @param targets_mm  ascending or descending, which they remain
[[nodiscard]] std::vector<double> moved_targets(std::vector<double> targets_mm);

}  // namespace ecs
