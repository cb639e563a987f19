// Text of files and units as a terminal may see it.
// Does not live here: JSON, which has its own escapes (json.hpp).
#pragma once

#include <string>
#include <string_view>

namespace ecs {

/// The same text, with nothing in it that a terminal would act on: control characters (C0 without line feed and tab,
/// DEL, C1), marks that turn the direction of writing, and bytes that are no UTF-8 each become '?'. Valid UTF-8 stays.
[[nodiscard]] std::string shown(std::string_view text);

}  // namespace ecs
