// `ecs` alone opens the screens.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace ecs::app {

/// Runs the screens where the words ask for nothing else (none, --ascii, --link LINK, files to open) and stdin and
/// stdout are a terminal that can show them; else says why on stderr where that is not plain.
/// @return exit code; nothing: the command line is not for the screens
[[nodiscard]] std::optional<int> screens_started(const std::vector<std::string>& words);

}  // namespace ecs::app
