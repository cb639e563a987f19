// Every verb of `ecs-emulator`, in the order of its help.
// Does not live here: what a verb does (its own file of this folder).
#pragma once

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

/// What `ecs-emulator --help` says first.
inline constexpr const char* kProgramHelp =
    "The virtual workshop: a machine tool with its E.C.S. unit and a laser to measure it.";

/// @param context  takes the arguments that the verbs of a menu share
[[nodiscard]] Registry all_verbs(VerbContext& context);

}  // namespace ecs::emulator
