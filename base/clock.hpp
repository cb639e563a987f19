// The time of day as the files and messages write it, and dates of the calendar.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace ecs {

/// "2026-05-04T09:30:00Z"
[[nodiscard]] std::string now_utc();
/// The same of seconds since 1970.
[[nodiscard]] std::string utc_of(std::int64_t unix_s);

/// Of a clock that never runs back, for spans of time only.
[[nodiscard]] double steady_s();

/// Whether `text` is a day that exists, as ISO 8601 writes it, with or without a time of that day: "2026-03-12",
/// "2026-03-12T09:10", "2026-03-12 09:10:11Z". Blanks around it do not matter.
[[nodiscard]] bool is_iso_date(std::string_view text);

/// Why `text` cannot be the date of a header, with what is expected; nothing if it can. No text at all can.
[[nodiscard]] std::optional<std::string> wrong_date(std::string_view text);

}  // namespace ecs
