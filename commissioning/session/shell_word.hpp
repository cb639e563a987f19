// Words of a command that a person pastes into a shell.
#pragma once

#include <string>
#include <vector>

namespace ecs::commissioning {

/// As a POSIX shell takes it: quoted where it holds more than letters, digits and signs that mean nothing there.
[[nodiscard]] std::string shell_word(const std::string& word);
/// A whole command.
[[nodiscard]] std::string shell_command(const std::vector<std::string>& words);

}  // namespace ecs::commissioning
