// The unit in a few words, for the line that stands on every screen.
#pragma once

#include <optional>

#include "app/ui/screen_program.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

[[nodiscard]] StatusLine status_line_of(const WatchedUnit& unit, const std::optional<protocol::MonitorSample>& newest);

}  // namespace ecs::app
