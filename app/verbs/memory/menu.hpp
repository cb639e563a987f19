// The parts of the menu MEMORY ACCESS: bytes between unit and file, and what they mean.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

/// read, write, dump, load
void add_memory_transfer(Menu& menu);
/// show, compare
void add_memory_decoding(Menu& menu);

}  // namespace ecs::app
