// The keyboard of a terminal: lines of a descriptor.
#pragma once

#include <memory>

#include "app/names/commissioning.hpp"
#include "commissioning/session/keyboard.hpp"

namespace ecs::app {

/// Lines of any descriptor, read without waiting. The descriptor stays the caller's.
[[nodiscard]] std::shared_ptr<Keyboard> keyboard_of(int descriptor);
[[nodiscard]] std::shared_ptr<Keyboard> keyboard_of_stdin();

}  // namespace ecs::app
