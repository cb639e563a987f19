#include "commissioning/memory/pattern.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/memory/space.hpp"

namespace ecs::commissioning {
namespace {

using Pattern = std::vector<std::uint8_t>;

Result<Pattern> whole_pattern(std::string_view digits, std::size_t bytes) {
  const auto value = integer_in(digits);
  const auto bits = static_cast<int>(8 * bytes);
  const bool fits = value && (bytes == 8 || (*value >= -(1ll << (bits - 1)) && *value < (1ll << bits)));
  if (!fits)
    return problem(ProblemKind::usage,
                   fmt::format("expected a whole number of {} bits after {}:, got \"{}\"", bits, bits, digits));
  Pattern pattern(8);
  store_big(Bytes(pattern), 0, static_cast<std::uint64_t>(*value));
  return Pattern(pattern.end() - static_cast<std::ptrdiff_t>(bytes), pattern.end());
}

Result<Pattern> real_pattern(std::string_view digits) {
  const auto value = number_in(digits);
  if (!value) return problem(ProblemKind::usage, fmt::format("expected a number after f:, got \"{}\"", digits));
  Pattern pattern(8);
  store_double(Bytes(pattern), 0, *value);
  return pattern;
}

}  // namespace

Result<std::vector<std::uint8_t>> pattern_in(std::string_view typed) {
  const std::string_view text = trimmed(typed);
  if (text.starts_with('"')) {
    const std::string_view inner = text.substr(1, text.ends_with('"') && text.size() > 1 ? text.size() - 2 : text.npos);
    if (inner.empty()) return problem(ProblemKind::usage, "expected text between the quotes, got none");
    return Pattern(inner.begin(), inner.end());
  }
  if (text.starts_with("f:")) return real_pattern(text.substr(2));
  for (const auto& [sign, bytes] : {std::pair{"8:", 1u}, {"16:", 2u}, {"32:", 4u}, {"64:", 8u}})
    if (text.starts_with(sign)) return whole_pattern(text.substr(text.find(':') + 1), bytes);
  auto bytes = hex_bytes({std::string(text)});
  if (!bytes) return problem(ProblemKind::usage, fmt::format("{}; give {}", bytes.error().message, kPatternHint));
  if (bytes->empty())
    return problem(ProblemKind::usage, fmt::format("expected bytes, got none; give {}", kPatternHint));
  return bytes;
}

SearchStep find_pattern(const MemoryBytes& memory, ByteView pattern, Address from) {
  const MemoryRegion* region = memory.region_of(from);
  if (region == nullptr || pattern.empty()) return {};
  const std::uint32_t left = region->size - (from - region->first);
  const ByteView known = memory.known(from, left);
  const auto found = std::search(known.begin(), known.end(), pattern.begin(), pattern.end());
  if (found != known.end()) return {SearchStep::Kind::found, from + static_cast<Address>(found - known.begin())};
  if (known.size() < left) return {SearchStep::Kind::unread, from + static_cast<Address>(known.size())};
  return {};
}

}  // namespace ecs::commissioning
