// Calendar dates as ECS writes them. Does not live here: dates of other programs' files (laser/import/time.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ecs {

/// Whether `text` is a day that exists, as ISO 8601 writes it, with or without a time of that day: "2026-03-12",
/// "2026-03-12T09:10", "2026-03-12 09:10:11Z". Blanks around it do not matter.
[[nodiscard]] bool is_iso_date(std::string_view text);

/// Why `text` cannot be the date of a header, with what is expected; nothing if it can. No text at all can.
[[nodiscard]] std::optional<std::string> wrong_date(std::string_view text);

}  // namespace ecs
