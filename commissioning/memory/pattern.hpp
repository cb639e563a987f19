// What is typed to be found in memory or written into it: bytes, text or a number.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/memory/bytes.hpp"

namespace ecs::commissioning {

/// `45 43 53` bytes, `"ECSI"` text, `16:-250` and `8:`, `32:`, `64:` whole numbers of so many bits, `f:0.01` a real
/// number of 8 bytes; all as the unit stores them, high byte first. A usage problem for anything else.
[[nodiscard]] Result<std::vector<std::uint8_t>> pattern_in(std::string_view typed);
inline constexpr std::string_view kPatternHint = "bytes 45 43, text \"ECSI\", or numbers 8:255 16:-250 32:70000 f:0.01";

/// How far a search is.
struct SearchStep {
  enum class Kind { found, unread, nowhere };
  Kind kind = Kind::nowhere;
  Address address = 0;  ///< of what was found, or of the first byte that must be read to go on
};
/// From `from` to the end of its region.
[[nodiscard]] SearchStep find_pattern(const MemoryBytes& memory, ByteView pattern, Address from);

}  // namespace ecs::commissioning
