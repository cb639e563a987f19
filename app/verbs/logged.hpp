// What verbs do, written into the logbook of the machine: which verb makes which kind of entry.
// Does not live here: the logbook (commissioning/logbook), transfers to units, which it sees whoever sends.
#pragma once

#include <string>
#include <vector>

#include "app/cli/around_verb.hpp"

namespace ecs::app {

/// Runs the verb of these words, sees the files that it reads and writes, and adds an entry if it was of use. Says what
/// there is to say of the logbook. Nothing is added where this process keeps none.
[[nodiscard]] AroundVerb logged_verb(const std::vector<std::string>& words);

}  // namespace ecs::app
