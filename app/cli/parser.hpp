// Words of a command line against the registry of verbs.
// Does not live here: running what was asked for (program.hpp), the command-line library (base/cli).
#pragma once

#include <string>
#include <vector>

#include "app/cli/verb.hpp"
#include "base/cli/command_tree.hpp"
#include "base/cli/shown_program.hpp"

namespace ecs::app {

/// What the words ask for.
struct ParsedWords {
  cli::Request request;
  Action action;  ///< of a verb to run
};

/// Takes --json, --quiet and --link into `context`. @param words  without the name of the program
[[nodiscard]] ParsedWords parsed(const VerbRegistry& registry, const std::vector<std::string>& words,
                                 VerbContext& context);

/// The program as its help knows it, for manual pages and completions.
[[nodiscard]] cli::ShownProgram shown_program(const VerbRegistry& registry, VerbContext& context);

}  // namespace ecs::app
