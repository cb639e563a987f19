#include "app/verbs/laser/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_laser_menu(Menu& root) {
  Menu menu = root.menu("laser", "PROCESS LASER DATA: measurements");
  add_laser_import(menu);
  add_laser_show(menu);
  add_laser_stats(menu);
  add_laser_process(menu);
  add_laser_normalise(menu);
  add_laser_air(menu);
  add_laser_table(menu);
  add_laser_capture(menu);
  add_laser_devices(menu);
}

}  // namespace ecs::app
