#include "app/verbs/utility/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_utility_menu(Menu& root) {
  Menu menu = root.menu("utility", "ECS UTILITY");
  add_utility_commands(menu);
  add_utility_mode(menu);
  add_utility_datum(menu);
  add_utility_status(menu);
}

}  // namespace ecs::app
