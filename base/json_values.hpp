// Values out of JSON that somebody else wrote: what is absent or of another type is none. Only for .cpp files (heavy
// header).
#pragma once

#include <optional>
#include <string>

#include "base/json.hpp"

namespace ecs {

/// Empty where the object has no text under the key, or is no object.
[[nodiscard]] inline std::string text_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

[[nodiscard]] inline std::optional<double> number_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

}  // namespace ecs
