// The time of day as files state it.
#pragma once

#include <string>

namespace ecs::app {

/// "2026-05-04T09:30:00Z"
[[nodiscard]] std::string now_utc();

}  // namespace ecs::app
