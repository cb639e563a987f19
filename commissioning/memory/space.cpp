#include "commissioning/memory/space.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::uint32_t kAddressSpace = 0x1000000;  ///< 24 bits

std::optional<std::uint8_t> nibble(char c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint8_t>(c - '0');
  const char low = static_cast<char>(c | 0x20);
  if (low >= 'a' && low <= 'f') return static_cast<std::uint8_t>(low - 'a' + 10);
  return std::nullopt;
}

/// "4E75" or "0x4E75"
Result<void> take_hex(std::string_view word, std::vector<std::uint8_t>& bytes) {
  const std::string_view whole = word;
  if (word.starts_with("0x") || word.starts_with("0X")) word.remove_prefix(2);
  if (word.size() % 2 != 0)
    return problem(ProblemKind::usage, fmt::format("expected bytes as pairs of hexadecimal digits, got \"{}\"", whole));
  for (std::size_t i = 0; i < word.size(); i += 2) {
    const auto high = nibble(word[i]), low = nibble(word[i + 1]);
    if (!high || !low)
      return problem(ProblemKind::usage, fmt::format("expected hexadecimal digits, got \"{}\"", whole));
    bytes.push_back(static_cast<std::uint8_t>(*high << 4 | *low));
  }
  return {};
}

}  // namespace

std::uint32_t size_of(const Region& region, std::size_t modules) {
  const bool is_bank = region.first == kBankA.first || region.first == kBankB.first;
  return is_bank ? bank_bytes(static_cast<std::uint8_t>(std::min(modules, kMostModules))) : region.size;
}

Result<void> within_space(Address address, std::size_t bytes) {
  if (bytes == 0) return problem(ProblemKind::usage, "expected at least 1 byte, got 0");
  if (address < kAddressSpace && bytes <= kAddressSpace - address) return {};
  return problem(ProblemKind::usage,
                 fmt::format("{} bytes from {}: the unit's memory lies below 0x1000000", bytes, hex_address(address)));
}

Result<void> memory_there(Address address, std::size_t bytes, std::size_t modules) {
  std::string map;
  for (const Region& region : kRegions) {
    const std::uint32_t size = size_of(region, modules);
    if (address >= region.first && address - region.first + bytes <= size) return {};
    map += fmt::format("{}{} {} to {}", map.empty() ? "" : ", ", region.name, hex_address(region.first),
                       hex_address(region.first + size - 1));
  }
  return problem(ProblemKind::refused, fmt::format("{} bytes from {}: the unit has no memory there; it has {}", bytes,
                                                   hex_address(address), map));
}

Result<std::vector<std::uint8_t>> hex_bytes(const std::vector<std::string>& arguments) {
  std::vector<std::uint8_t> bytes;
  for (const std::string& argument : arguments)
    for (const std::string_view word : split(argument, ' ')) ECS_DO(take_hex(trimmed(word), bytes));
  return bytes;
}

}  // namespace ecs::commissioning
