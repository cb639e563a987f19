// `ecs` alone opens the screens, files on the command line open in the screen that works with them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

/// Runs the screens where the words ask for nothing else (none, --ascii, --link LINK, files to open) and stdin and
/// stdout are a terminal that can show them; else says why on stderr where that is not plain.
/// @return exit code; nothing: the command line is not for the screens
[[nodiscard]] std::optional<int> screens_started(const std::vector<std::string>& words);

/// The screen for what the files are: a model with measurements in MODEL, measurements alone and an error map in
/// PROCESS LASER DATA, parameters or a machine file in E.C.S. PARAMETERS, a dump in MEMORY, a datum sequence, the state
/// of a unit. Null: none works with them; the log says so.
[[nodiscard]] std::unique_ptr<Screen> screen_for_files(const std::vector<std::string>& paths,
                                                       const std::shared_ptr<UnitConnection>& connection);

}  // namespace ecs::app
