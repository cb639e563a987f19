// What a subject beside the thesis's job brings to `ecs-emulator`: its verbs. As in app/cli/module.hpp.
#pragma once

#include <vector>

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

struct Module {
  cli::Family<VerbContext> verbs;
};

/// In the order of their names.
[[nodiscard]] const std::vector<const Module*>& modules();

}  // namespace ecs::emulator
