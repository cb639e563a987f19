// The time of day as files state it.
#pragma once

#include <cstdint>
#include <string>

namespace ecs {

/// "2026-05-04T09:30:00Z"
[[nodiscard]] std::string now_utc();
/// The same of seconds since 1970.
[[nodiscard]] std::string utc_of(std::int64_t unix_s);

/// Of a clock that never runs back, for spans of time only.
[[nodiscard]] double steady_s();

}  // namespace ecs
