// Messages of the parser of formulas (muParser), which count places from 0: the caller states the place, counted
// from 1.
#pragma once

#include <string>

namespace ecs {

/// `Unexpected token "t" found at position 4.` without its place: `Unexpected token "t".`
[[nodiscard]] inline std::string without_position(std::string message) {
  constexpr const char* kDigits = "0123456789";
  const std::string place = " at position ", found = " found";
  const std::size_t at = message.find(place);
  if (at == std::string::npos) return message;
  const std::size_t end = message.find_first_not_of(kDigits, at + place.size());
  const std::size_t begin = message.substr(0, at).ends_with(found) ? at - found.size() : at;
  return message.erase(begin, end == std::string::npos ? end : end - begin);
}

}  // namespace ecs
