// Bytes as letters (RFC 4648, 4), without line breaks.
#pragma once

#include <string>
#include <string_view>

namespace ecs {

[[nodiscard]] std::string base64_of(std::string_view bytes);

}  // namespace ecs
