// Which conditions of ISO 230-2:2014 a measurement does not meet, in words.
// Does not live here: the evaluation (iso230.hpp).
#pragma once

#include <string>
#include <vector>

#include "laser/analysis/iso230.hpp"

namespace ecs::laser {

/// One sentence for each condition that is not met (clause 5: targets, runs, approaches) and for readings left out.
[[nodiscard]] std::vector<std::string> iso230_notes(const MeasurementSet& set, const Group& group, const Iso230& axis);

}  // namespace ecs::laser
