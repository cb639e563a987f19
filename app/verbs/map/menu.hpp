// The verbs of PROCESS LASER DATA that work on error maps, a file each.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

void add_map_build(Menu& menu);
void add_map_show(Menu& menu);
void add_map_header(Menu& menu);
void add_map_send(Menu& menu);
void add_map_receive(Menu& menu);
void add_map_verify(Menu& menu);

}  // namespace ecs::app
