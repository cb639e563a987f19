// The verbs of `ecs export`: the map as compensation tables of other controls, and back.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

void add_export_writers(Menu& menu);  ///< one for each controller format
void add_export_read(Menu& menu);

}  // namespace ecs::app
