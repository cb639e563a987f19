// The verbs of `ecs-emulator`: what base/cli defines, with what a verb of this program is given; the machine that a
// verb makes; signals that end a verb in good order. Does not live here: the list of verbs (registry.cpp).
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include <sys/types.h>

#include "base/cli/action.hpp"

namespace ecs::emulator {

using cli::action;
using cli::Fields;
using cli::Need;
using cli::Words;

struct VerbContext {
  std::string workshop;  ///< of the verbs of a running workshop: the server's socket
  pid_t parent = 0;      ///< the process that started this one
};

using Action = cli::Action<VerbContext>;
using Registry = cli::Registry<VerbContext>;

/// The machine that a verb makes.
struct MachineArguments {
  std::string machine, errors;
  std::optional<std::uint64_t> seed;

  static Fields<MachineArguments> fields() {
    using A = MachineArguments;
    return {{"--machine", &A::machine, "machine file (TOML)", Need::required},
            {"--errors", &A::errors, "errors file (TOML); default: as in the machine file"},
            {"--seed", &A::seed, "seed of all random values"}};
  }
};

/// Set by SIGTERM and SIGINT once stop_on_signals() was called.
[[nodiscard]] const std::atomic<int>& stop_requested();

void stop_on_signals();

/// Ends with the process that started this one, not with the thread of it that did: the signal comes for either.
/// @return false: the parent has ended already
[[nodiscard]] bool stop_with_parent(pid_t parent);

/// What `ecs-emulator --help` says first.
inline constexpr const char* kProgramHelp =
    "The virtual workshop: a machine tool with its E.C.S. unit and a laser to measure it.";

/// @param context  takes the arguments that the verbs of a menu share
[[nodiscard]] Registry all_verbs(VerbContext& context);

}  // namespace ecs::emulator
