// The arguments of every verb of MODEL that reads a model and measured files.
// Does not live here: reading them (commissioning/models/work.hpp).
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/models/work.hpp"

namespace ecs::app {

/// Adds MODEL, DATA, --machine and the options of `laser import`.
struct ModelOptions : ModelArguments {
  explicit ModelOptions(Verb& verb, Need data_need = Need::required);
};
inline constexpr const char* kMachineHelp = "the machine (.toml): datum, travels, lever arms, pitches";

}  // namespace ecs::app
