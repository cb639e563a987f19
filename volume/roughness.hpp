// The noise of a table from its own roughness.
#pragma once

#include <vector>

namespace ecs::volume {

/// Standard deviation of independent noise from third differences (J. von Neumann et al., Ann. Math. Stat. 12 (1941)
/// 153, for first differences); their median, so that a bend of the curve does not count as noise.
[[nodiscard]] double roughness_of(const std::vector<double>& values);

}  // namespace ecs::volume
