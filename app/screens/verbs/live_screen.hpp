// A verb that talks with whoever runs it: what comes next in the upper row, what it said below as it says it, a line to
// type into.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"

namespace ecs::app {

/// Whether a verb ("laser capture") is run by this screen rather than below its form.
[[nodiscard]] bool runs_live(const std::string& verb);

/// @param words  the command line; it is run at once
[[nodiscard]] std::unique_ptr<Screen> live_screen(std::string name, const std::vector<std::string>& words);

}  // namespace ecs::app
