// The header of a measured file or a map: lines "# key: value" before its table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ecs::commissioning {

struct HeaderLine {
  std::string key;         ///< in lower case
  std::string_view value;  ///< without blanks around it
};

/// As far as lines begin with #; those without a colon are left out. Views into `content`.
[[nodiscard]] std::vector<HeaderLine> header_lines(std::string_view content);

}  // namespace ecs::commissioning
