// Dates and times of day as files hold them. Does not live here: which column holds one.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ecs::laser {

/// Seconds since the start of 1970 of "2022-11-08 14:07:19.279", "2022-11-08T14:07:19Z" or "08.11.2022 14:07:19";
/// since midnight of "14:07:19.279". Whatever zone the clock had. Nothing for other forms.
[[nodiscard]] std::optional<double> seconds_in(std::string_view text);

/// "2022-11-08 14:07:19.279"; empty for a time of day, which is no date.
[[nodiscard]] std::string date_time_text(double seconds);

/// The key of the metadata that says when `time_s` is 0.
inline constexpr std::string_view kBegun = "begun";

}  // namespace ecs::laser
