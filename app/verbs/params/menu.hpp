// The parts of the menu E.C.S. PARAMETERS, a file each: what works on files, and what talks to a unit.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

void add_params_show(Menu& menu);
void add_params_check(Menu& menu);
void add_params_set(Menu& menu);
void add_params_diff(Menu& menu);
void add_params_new(Menu& menu);
void add_params_send(Menu& menu);
void add_params_receive(Menu& menu);

}  // namespace ecs::app
