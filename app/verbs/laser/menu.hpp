// The verbs of PROCESS LASER DATA that work on measurements, a file each.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

void add_laser_import(Menu& menu);
void add_laser_show(Menu& menu);
void add_laser_stats(Menu& menu);
void add_laser_process(Menu& menu);
void add_laser_normalise(Menu& menu);
void add_laser_air(Menu& menu);
void add_laser_table(Menu& menu);
void add_laser_capture(Menu& menu);
void add_laser_devices(Menu& menu);

}  // namespace ecs::app
