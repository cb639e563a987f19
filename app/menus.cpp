#include "app/menus.hpp"

namespace ecs::app {

void add_all_menus(Menu& root) {
  add_params_menu(root);
  add_monitor_verb(root);
  add_utility_menu(root);
}

}  // namespace ecs::app
