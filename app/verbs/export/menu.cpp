#include "app/verbs/export/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_export_menu(Menu& root) {
  Menu menu = root.menu("export", "the error map as compensation tables of other controls, and back");
  add_export_writers(menu);
  add_export_read(menu);
}

}  // namespace ecs::app
