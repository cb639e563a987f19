// `ecs --linear`: menus and verbs as numbered lines, for screen readers, teletypes and lines on which no cursor moves.
// Does not live here: the screens (app/screens), what a verb does.
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <string>
#include <vector>

#include "base/cli/documents.hpp"

namespace ecs::app {

/// Runs `ecs words…`; says all on its own. @return exit code
using RunWords = std::function<int(const std::vector<std::string>& words)>;

/// Asks and answers line by line until `q` at the first menu or the end of `in`. Each question names what it takes and
/// what an empty line means; the command that a choice comes to is shown before it runs.
/// @return exit code of the last verb that ran, 0 if none did
[[nodiscard]] int run_linear(const cli::ShownProgram& program, const RunWords& run, std::istream& in,
                             std::ostream& out);

}  // namespace ecs::app
