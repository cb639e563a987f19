// The verbs of `ecs-emulator`: what base/cli defines, with what a verb of this program is given; the machine that a
// verb makes; signals that end a verb in good order. Does not live here: the list of verbs (registry.cpp).
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <utility>

#include <sys/types.h>

#include "base/cli/verb.hpp"

namespace ecs::emulator {

using cli::Need;
using cli::Verb;

struct VerbContext {
  std::string workshop;  ///< of the verbs of a running workshop: the server's socket
  pid_t parent = 0;      ///< the process that started this one
};

using VerbDefinition = cli::VerbDefinition<VerbContext>;
using Action = VerbDefinition::Action;

/// The definition of a verb with arguments of its own, which live as long as its action.
template <class Arguments>
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example,
                                  void (*declare)(Verb&, Arguments&),
                                  Result<Outcome> (*run)(VerbContext&, const Arguments&)) {
  return cli::defined_verb<VerbContext, Arguments>(std::move(path), std::move(help), std::move(example), declare, run);
}

/// The machine that a verb makes.
struct MachineArguments {
  std::string machine;
  std::string errors;
  std::optional<std::uint64_t> seed;

  void declare(Verb& verb) {
    verb.text("--machine", machine, "machine file (TOML)", Need::required)
        .text("--errors", errors, "errors file (TOML); default: the one that the machine file names")
        .seed(seed, "seed of everything random");
  }
};

/// Set by SIGTERM and SIGINT once stop_on_signals() was called.
[[nodiscard]] const std::atomic<int>& stop_requested();

void stop_on_signals();

/// Ends with the process that started this one, not with the thread of it that did: the signal comes for either.
/// @return false: the parent has ended already
[[nodiscard]] bool stop_with_parent(pid_t parent);

}  // namespace ecs::emulator
