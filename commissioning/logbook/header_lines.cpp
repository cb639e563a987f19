#include "commissioning/logbook/header_lines.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace ecs::commissioning {

std::vector<HeaderLine> header_lines(std::string_view content) {
  constexpr std::size_t kMostLines = 200;
  std::vector<HeaderLine> lines;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < kMostLines && begin < content.size(); ++k) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view text = trimmed(content.substr(begin, end - begin));
    begin = end + 1;
    if (!text.starts_with('#')) break;
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) continue;
    lines.push_back({lower(trimmed(text.substr(1, colon - 1))), trimmed(text.substr(colon + 1))});
  }
  return lines;
}

}  // namespace ecs::commissioning
