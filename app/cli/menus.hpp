// The menus of the program (thesis figure 5.4), each in a file of its own.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

/// Every menu and verb, in the order in which the help shows them. A new menu is a line in menus.cpp.
void add_all_menus(Menu& root);

void add_params_menu(Menu& root);
void add_monitor_verb(Menu& root);
void add_laser_menu(Menu& root);
void add_map_menu(Menu& root);
void add_utility_menu(Menu& root);
void add_memory_menu(Menu& root);
void add_model_menu(Menu& root);
void add_export_menu(Menu& root);
void add_batch_verb(Menu& root);
void add_doctor_verb(Menu& root);
void add_report_verb(Menu& root);

}  // namespace ecs::app
