// Completion of verbs, options and words of a choice in a shell. Does not live here: where the file goes (README.md).
#pragma once

#include <string>

#include "base/cli/shown_program.hpp"

namespace ecs::cli {

/// A script for the shell; where an argument is no verb, option or choice, the shell offers files.
[[nodiscard]] std::string bash_completion(const ShownProgram& program);
[[nodiscard]] std::string zsh_completion(const ShownProgram& program);
[[nodiscard]] std::string fish_completion(const ShownProgram& program);

}  // namespace ecs::cli
