// The verbs of `ecs-emulator`: what base/cli defines, with what a verb of this program is given.
// Does not live here: the list of verbs (registry.cpp).
#pragma once

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

}  // namespace ecs::emulator
