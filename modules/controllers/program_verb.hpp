// `ecs export program`. Does not live here: the correction (corrected_program.hpp).
#pragma once

#include <vector>

#include "app/cli/verb.hpp"

namespace ecs::app {

[[nodiscard]] const std::vector<Action>& export_of_programs();

}  // namespace ecs::app
