#include "app/verbs/model/menu.hpp"

#include "app/cli/menus.hpp"

namespace ecs::app {

void add_model_menu(Menu& root) {
  Menu menu = root.menu("model", "MODEL: the error model against measurements");
  add_model_effects(menu);
  add_model_new(menu);
  add_model_predict(menu);
  add_model_fit(menu);
  add_model_compare(menu);
  add_model_diagnose(menu);
  add_model_next(menu);
  add_model_add(menu);
  add_model_undo(menu);
  add_model_history(menu);
  add_model_what_if(menu);
  add_model_reveal(menu);
}

}  // namespace ecs::app
