// The parts of the menu ECS UTILITY, a few verbs a file.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

/// status
void add_utility_status(Menu& menu);
/// position, output, run, mode, reset, clear, ramtest
void add_utility_commands(Menu& menu);
void add_utility_mode(Menu& menu);
/// datum record, show, test
void add_utility_datum(Menu& menu);

}  // namespace ecs::app
