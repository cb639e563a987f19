#include "app/params_menu.hpp"

#include "app/menus.hpp"

namespace ecs::app {

void add_params_menu(Menu& root) {
  Menu menu = root.menu("params", "E.C.S. PARAMETERS");
  add_params_check(menu);
}

}  // namespace ecs::app
