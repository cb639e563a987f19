#include "laser/column_words.hpp"

#include <cctype>
#include <functional>
#include <map>

#include "base/text.hpp"

namespace ecs::laser {

std::vector<std::string> heading_words(std::string_view heading) {
  std::vector<std::string> words{""};
  for (const char c : lower(heading)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 || std::isalnum(byte) != 0)
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  return words;
}

std::optional<Approach> approach_named(std::string_view word) {
  static const std::map<std::string, Approach, std::less<>> kWords{
      {"1", Approach::forward},        {"+1", Approach::forward},      {"+", Approach::forward},
      {"f", Approach::forward},        {"fwd", Approach::forward},     {"forward", Approach::forward},
      {"up", Approach::forward},       {"pos", Approach::forward},     {"-1", Approach::reverse},
      {"-", Approach::reverse},        {"r", Approach::reverse},       {"b", Approach::reverse},
      {"rev", Approach::reverse},      {"reverse", Approach::reverse}, {"bwd", Approach::reverse},
      {"backward", Approach::reverse}, {"down", Approach::reverse},    {"neg", Approach::reverse},
      {"0", Approach::unknown},        {"", Approach::unknown}};
  const auto found = kWords.find(lower(word));
  return found == kWords.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace ecs::laser
