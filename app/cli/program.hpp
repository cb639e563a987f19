// A command line from its words to its exit code; what a program knows of its verbs for manual pages and completions.
// Does not live here: which verbs there are (app/verbs/registry.hpp), what they do.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "app/cli/console.hpp"
#include "app/cli/verb.hpp"
#include "base/cli/command_tree.hpp"
#include "base/cli/documents.hpp"

namespace ecs::app {

/// What the words ask for.
struct ParsedWords {
  cli::Request request;
  const Action* action = nullptr;  ///< of a verb to run
  Action::Run run{};               ///< with what the words gave it
};

/// Takes --json, --quiet and --link into `context`. @param words  without the name of the program
[[nodiscard]] ParsedWords parsed(const Registry& registry, const std::vector<std::string>& words, VerbContext& context);

/// The program as its help knows it, for manual pages and completions.
[[nodiscard]] cli::ShownProgram shown_program(const Registry& registry, VerbContext& context);

/// Runs an action, with what is to be done before and after it.
using AroundVerb = std::function<Result<Outcome>(VerbContext&, const Action&, const Action::Run&)>;

/// Runs `ecs words…`. Results go to `out`, messages to `messages`; no exception leaves it.
/// @param words  without the name of the program
/// @param around  empty: nothing
/// @return the exit code: 0 … 5, 128 + n if signal n came
[[nodiscard]] int run_command_line(const Registry& registry, const std::vector<std::string>& words, std::ostream& out,
                                   std::ostream& messages, ConsoleOptions options = {}, const AroundVerb& around = {});

/// Another command line of the program that runs this verb: for one that does others again.
[[nodiscard]] int run_same_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages);

}  // namespace ecs::app
