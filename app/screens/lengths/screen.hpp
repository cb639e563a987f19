// The screen LENGTHS: the 21 components from measured lengths, what is not determined, a plan with the fewest minutes.
// Does not live here: the computation and its files (commissioning/lengths).
#pragma once

#include <memory>
#include <string>

#include "app/ui/screen.hpp"

namespace ecs::app {

/// @param lengths, machine, params  files that are known already; empty: asked for
[[nodiscard]] std::unique_ptr<Screen> lengths_screen(const std::string& lengths = {}, const std::string& machine = {},
                                                     const std::string& params = {});

}  // namespace ecs::app
