// Every verb of `ecs-emulator`, in the order of its help.
// Does not live here: what a verb does (its own file of this folder).
#pragma once

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

/// @param context  takes the arguments that the verbs of a menu share
[[nodiscard]] cli::VerbRegistry<VerbContext> all_verbs(VerbContext& context);

}  // namespace ecs::emulator
