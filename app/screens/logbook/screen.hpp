// LOGBOOK: what was done at a machine, one entry whole, whether all of it still stands as it was written.
#pragma once

#include <memory>

#include "app/ui/screen.hpp"

namespace ecs::app {

[[nodiscard]] std::unique_ptr<Screen> logbook_screen();

}  // namespace ecs::app
