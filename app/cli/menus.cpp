#include "app/cli/menus.hpp"

namespace ecs::app {

void add_all_menus(Menu& root) {
  add_params_menu(root);
  add_monitor_verb(root);
  add_laser_menu(root);
  add_map_menu(root);
  add_utility_menu(root);
  add_memory_menu(root);
  add_model_menu(root);
  add_report_verb(root);
  add_export_menu(root);
  add_batch_verb(root);
  add_doctor_verb(root);
}

}  // namespace ecs::app
