// The verbs of `ecs` (thesis figure 5.4). A new verb is its file and a row in registry.cpp.
// Does not live here: how a command line is parsed and answered (app/cli/).
#pragma once

#include "app/cli/program.hpp"

namespace ecs::app {

/// Every menu and verb, in the order in which the help shows them.
[[nodiscard]] const Registry& all_verbs();

/// From now on modules work in the background: records of what is done are kept. A library or a test that does not call
/// it has none of that.
void begin_modules();

/// Runs `ecs words…` with all verbs; as run_command_line().
[[nodiscard]] int run_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages,
                              ConsoleOptions options = {});

/// `ecs --linear`: the same verbs from numbered menus, a line at a time (app/cli/linear.hpp).
[[nodiscard]] int run_linear_program(std::istream& in, std::ostream& out, std::ostream& messages);

}  // namespace ecs::app
