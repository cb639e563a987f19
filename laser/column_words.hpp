// Words of headings and cells that mean something whatever the file. Does not live here: the columns of the measurement
// CSV (csv_columns.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"

namespace ecs::laser {

/// The words of a heading in lower case: "Target_mm" and "target (mm)" are target and mm. At least one, perhaps empty.
[[nodiscard]] std::vector<std::string> heading_words(std::string_view heading);

/// "forward", "rev", "+", "down", "1", … in any case; an empty word is unknown. Nothing for other words.
[[nodiscard]] std::optional<Approach> approach_named(std::string_view word);

}  // namespace ecs::laser
