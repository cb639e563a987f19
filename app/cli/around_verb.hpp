// What is done around every verb of the program, and verbs that do others again.
// Does not live here: a command line as such (program.hpp).
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "app/cli/program.hpp"

namespace ecs::app {

/// Runs the action of a verb, with what is to be done before and after it.
using AroundVerb = std::function<Result<Outcome>(VerbContext&, const Action&)>;

/// run_command_line() with something around the verb.
[[nodiscard]] int run_command_line(const VerbRegistry& registry, const std::vector<std::string>& words,
                                   std::ostream& out, std::ostream& messages, ConsoleOptions options,
                                   const AroundVerb& around);

/// Another command line of the program that runs this verb: for one that does others again.
[[nodiscard]] int run_same_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages);

}  // namespace ecs::app
