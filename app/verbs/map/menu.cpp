#include "app/verbs/map/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_map_menu(Menu& root) {
  Menu menu = root.menu("map", "PROCESS LASER DATA: error maps");
  add_map_build(menu);
  add_map_show(menu);
  add_map_header(menu);
  add_map_send(menu);
  add_map_receive(menu);
  add_map_verify(menu);
}

}  // namespace ecs::app
