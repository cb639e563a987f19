// The verbs of `ecs`: what base/cli defines, with what a verb of this program is given.
// Does not live here: the list of verbs (app/verbs/registry.cpp), parsing (parser.hpp).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/cli/verb_context.hpp"
#include "base/cli/verb_arguments.hpp"

namespace ecs::app {

using cli::Access;
using cli::Need;
using cli::Verb;
using cli::VerbArgument;
using cli::VerbArguments;
using MenuDefinition = cli::Menu;
using VerbDefinition = cli::VerbDefinition<VerbContext>;
using VerbRegistry = cli::VerbRegistry<VerbContext>;
using Action = VerbDefinition::Action;

/// What `ecs --help` says first.
inline constexpr const char* kProgramHelp =
    "ECS: parameters, error maps and tests of an error compensation system for machine tools";

/// The definition of a verb with the arguments of a library. @param declare  names them
template <class Arguments>
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example,
                                  void (*declare)(Verb&, Arguments&),
                                  Result<Outcome> (*run)(VerbContext&, const Arguments&)) {
  return cli::defined_verb<VerbContext, Arguments>(std::move(path), std::move(help), std::move(example), declare, run);
}

/// The same with arguments that are members of their struct.
template <class Arguments>
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example,
                                  Result<Outcome> (*run)(VerbContext&, const Arguments&)) {
  return cli::defined_verb<VerbContext, Arguments>(std::move(path), std::move(help), std::move(example), run);
}

}  // namespace ecs::app
