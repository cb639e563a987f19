// The error anywhere in the working volume: files as fields, then sizes, a slice and the body diagonals.
#pragma once

#include <memory>

#include "app/ui/screen.hpp"

namespace ecs::app {

[[nodiscard]] std::unique_ptr<Screen> volume_screen();

}  // namespace ecs::app
