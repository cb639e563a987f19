#include "app/verbs/memory/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_memory_menu(Menu& root) {
  Menu menu = root.menu("memory", "MEMORY ACCESS");
  add_memory_transfer(menu);
  add_memory_decoding(menu);
}

}  // namespace ecs::app
