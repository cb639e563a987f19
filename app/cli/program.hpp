// A command line from its words to its exit code.
// Does not live here: which verbs there are (app/verbs/registry.hpp), what they do.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "app/cli/console.hpp"
#include "app/cli/verb.hpp"

namespace ecs::app {

/// Runs `ecs words…`. Results go to `out`, messages to `messages`; no exception leaves it.
/// @param words  without the name of the program
/// @return the exit code: 0 … 5, 128 + n if signal n came
[[nodiscard]] int run_command_line(const VerbRegistry& registry, const std::vector<std::string>& words,
                                   std::ostream& out, std::ostream& messages, ConsoleOptions options = {});

}  // namespace ecs::app
