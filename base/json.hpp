// JSON that the verbs answer with, where unknown is null, never NaN; values out of JSON that somebody else wrote, where
// what is absent or of another type is none. Only for .cpp files (heavy header).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "base/json_fwd.hpp"
#include "base/result.hpp"

namespace ecs {

/// A finite number, else null.
[[nodiscard]] Json number_or_null(double value);
[[nodiscard]] Json number_or_null(const std::optional<double>& value);
/// A text, or null if it is empty.
[[nodiscard]] Json text_or_null(std::string_view text);
/// On one line; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string one_line(const Json& value);
/// JSON out of a file: discarded where it is none, or where its arrays and objects are deeper than any that ECS writes.
[[nodiscard]] Json json_in(std::string_view text);
/// {"message", "file", "line", "column"}, and "also" with the other problems if there are any.
[[nodiscard]] Json problem_json(const Problem& problem);
/// "0x100000"
[[nodiscard]] std::string hex_address(std::uint32_t address);

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
