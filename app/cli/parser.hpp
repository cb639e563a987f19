// Words of a command line against the registry of verbs. The command-line library stops in parser.cpp.
// Does not live here: running what was asked for (program.hpp).
#pragma once

#include <string>
#include <vector>

#include "app/cli/verb.hpp"

namespace ecs::app {

/// What the words ask for.
struct Request {
  enum class Kind { run, help, version, overview, wrong };
  Kind kind = Kind::wrong;
  Action action;     ///< of a verb to run
  std::string text;  ///< the help, or what is wrong and what to do
};

/// Takes --json, --quiet and --link into `context`. @param words  without the name of the program
[[nodiscard]] Request parsed(const VerbRegistry& registry, const std::vector<std::string>& words, VerbContext& context);

}  // namespace ecs::app
