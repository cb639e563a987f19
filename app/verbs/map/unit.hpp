// A map from a file or from the unit, whichever the command line names.
// Does not live here: reading the unit's map (commissioning/maps/map_in_unit.hpp).
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/maps/map_in_unit.hpp"

namespace ecs::app {

/// `file`, or the unit's map with `from_unit`. A `usage` problem unless exactly one of the two is asked for.
[[nodiscard]] Result<FoundMap> found_map(VerbContext& context, const std::string& file, bool from_unit);

}  // namespace ecs::app
