#include "app/verbs/params/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_params_menu(Menu& root) {
  Menu menu = root.menu("params", "E.C.S. PARAMETERS");
  add_params_show(menu);
  add_params_check(menu);
  add_params_set(menu);
  add_params_diff(menu);
  add_params_new(menu);
  add_params_send(menu);
  add_params_receive(menu);
}

}  // namespace ecs::app
