// Whether the bytes of a file are text at all, before a reader stumbles over them in its own words.
// Does not live here: code pages (laser/text_decoding.hpp), what a text means.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// "UTF-16LE" or "UTF-16BE" where the bytes are one: by the mark, else by a zero in every second byte of the start.
[[nodiscard]] std::optional<const char*> utf16_order(std::string_view bytes);

/// For readers that take UTF-8 only: the problem with bytes that are UTF-16 or hold a NUL, with its place; else
/// nothing.
[[nodiscard]] std::optional<Problem> why_no_text(std::string_view bytes, const std::string& file_name);

}  // namespace ecs
