// A command line from its words to its exit code.
// Does not live here: what the verbs do (menus.hpp and the files it names).
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "app/cli/console.hpp"

namespace ecs::app {

/// Runs `ecs words…`. Results go to `out`, messages to `messages`; no exception leaves it.
/// @param words  without the name of the program
/// @return the exit code: 0 … 5, 128 + n if signal n came
[[nodiscard]] int run_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages,
                              ConsoleOptions options = {});

}  // namespace ecs::app
