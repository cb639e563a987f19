// The verbs of MODEL, a file each.
#pragma once

#include "app/cli/verb.hpp"

namespace ecs::app {

void add_model_effects(Menu& menu);
void add_model_new(Menu& menu);
void add_model_predict(Menu& menu);
void add_model_fit(Menu& menu);
void add_model_compare(Menu& menu);
void add_model_diagnose(Menu& menu);
void add_model_add(Menu& menu);
void add_model_undo(Menu& menu);
void add_model_history(Menu& menu);
void add_model_what_if(Menu& menu);
void add_model_next(Menu& menu);
void add_model_reveal(Menu& menu);

}  // namespace ecs::app
