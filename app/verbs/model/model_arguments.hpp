// The arguments of every verb of MODEL that reads a model and measured files.
// Does not live here: reading them (commissioning/models/work.hpp).
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/models/work.hpp"

namespace ecs::app {

/// Adds MODEL, DATA, --machine and the options of `laser import`.
void take_model_and_data(Verb& verb, ModelArguments& arguments, Need data = Need::required);
/// Adds --machine alone.
void take_machine(Verb& verb, std::string& machine);

}  // namespace ecs::app
