// Text kept from being read by accident: compressed, in base64, below a line that says how to open it. No secret:
// whoever wants to look, can. Does not live here: what is sealed (docs/emulator.md).
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// Bytes as letters (RFC 4648, 4), without line breaks.
[[nodiscard]] std::string base64_of(std::string_view bytes);

/// @param heading  one line, readable: what this is and how to open it
[[nodiscard]] std::string sealed(std::string_view text, std::string_view heading);

/// The text again; refuses what sealed() has not made, or what was changed since.
/// @param file  name used in problems
[[nodiscard]] Result<std::string> unsealed(std::string_view sealed_text, const std::string& file);

}  // namespace ecs
