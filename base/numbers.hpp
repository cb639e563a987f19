// Numbers as a user types them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// "0x100000" or "1048576": a whole number of 32 bits, else a usage problem that names `what`.
[[nodiscard]] Result<std::uint32_t> whole_number(std::string_view text, std::string_view what);

/// "1.234", or "-" where there is none: a cell of a table.
[[nodiscard]] std::string cell_text(const std::optional<double>& value);

}  // namespace ecs
