// `ecs FILE…`: each file in the screen that works with it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

/// The screen for what the files are: a model with measurements in MODEL, measurements alone and an error map in
/// PROCESS LASER DATA, parameters or a machine file in E.C.S. PARAMETERS, a dump in MEMORY, a datum sequence, the state
/// of a unit. Null: none works with them; the log says so.
[[nodiscard]] std::unique_ptr<Screen> screen_for_files(const std::vector<std::string>& paths,
                                                       const std::shared_ptr<UnitConnection>& connection);

}  // namespace ecs::app
