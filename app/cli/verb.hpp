// The verbs of `ecs`: what base/cli defines, with what a verb of this program is given.
// Does not live here: the list of verbs (app/verbs/registry.cpp), parsing (parser.hpp).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/cli/verb_context.hpp"
#include "base/cli/verb.hpp"

namespace ecs::app {

using cli::Need;
using cli::Verb;
using cli::VerbArgument;
using MenuDefinition = cli::Menu;
using VerbDefinition = cli::VerbDefinition<VerbContext>;
using VerbRegistry = cli::VerbRegistry<VerbContext>;
using Action = VerbDefinition::Action;

/// What `ecs --help` says first.
inline constexpr const char* kProgramHelp =
    "ECS: parameters, error maps and tests of an error compensation system for machine tools";

/// The definition of a verb with arguments of its own, which live as long as its action.
template <class Arguments>
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example,
                                  void (*declare)(Verb&, Arguments&),
                                  Result<Outcome> (*run)(VerbContext&, const Arguments&)) {
  return cli::defined_verb<VerbContext, Arguments>(std::move(path), std::move(help), std::move(example), declare, run);
}

/// The same for a verb without arguments of its own.
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example, void (*declare)(Verb&),
                                  Result<Outcome> (*run)(VerbContext&));

}  // namespace ecs::app
