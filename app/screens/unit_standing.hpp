// The unit in a few words, for the line that stands on every screen. Does not live here: the line
// (screens_program.hpp).
#pragma once

#include <optional>

#include "app/screens/screens_program.hpp"
#include "app/screens/unit_desk.hpp"

namespace ecs::app {

[[nodiscard]] Standing standing_of(const WatchedUnit& unit, const std::optional<protocol::MonitorSample>& newest);

}  // namespace ecs::app
