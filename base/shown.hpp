// Text of files and units as a terminal may see it.
// Does not live here: how JSON is made (json.hpp).
#pragma once

#include <string>
#include <string_view>

namespace ecs {

/// The same text, with nothing in it that a terminal would act on: control characters (C0 without line feed and tab,
/// DEL, C1), marks that turn the direction of writing, and bytes that are no UTF-8 each become '?'. Valid UTF-8 stays.
[[nodiscard]] std::string shown(std::string_view text);

/// JSON with the same characters as escapes (\u009b) in place of bytes; what it means stays. @param json  valid, UTF-8
[[nodiscard]] std::string shown_json(std::string_view json);

/// A line of at most so many bytes; of a longer one the beginning and how long it is.
[[nodiscard]] std::string cut_line(std::string_view line, std::size_t most);

}  // namespace ecs
