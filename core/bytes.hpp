// Big-endian numbers in the unit's memory (68000 byte order).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace ecs {

using ByteView = std::span<const std::uint8_t>;
using Bytes = std::span<std::uint8_t>;

/// @pre at + sizeof(T) <= bytes.size()
template <class T>
[[nodiscard]] constexpr T load_big(ByteView bytes, std::size_t at) noexcept {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>((value << 8) | bytes[at + i]);
  return value;
}
template <class T>
constexpr void store_big(Bytes bytes, std::size_t at, T value) noexcept {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (sizeof(T) - 1 - i)));
}

[[nodiscard]] constexpr double load_double(ByteView bytes, std::size_t at) noexcept {
  return std::bit_cast<double>(load_big<std::uint64_t>(bytes, at));
}
constexpr void store_double(Bytes bytes, std::size_t at, double value) noexcept {
  store_big(bytes, at, std::bit_cast<std::uint64_t>(value));
}

/// A record in battery-backed memory has two slots of equal size and is written into the older one, so that one is
/// sound whenever the supply fails.
/// @param region  both slots  @param read  of a slot: an optional with the member `sequence`; nothing: not sound
/// @return        the newer record; nothing: neither slot is sound
template <class Read>
[[nodiscard]] auto newest_record(ByteView region, Read read) noexcept {
  const std::size_t slot_bytes = region.size() / 2;
  const auto first = read(region.first(slot_bytes)), second = read(region.subspan(slot_bytes));
  if (first && second) return first->sequence > second->sequence ? first : second;
  return first ? first : second;
}
/// The slot (0 or 1) to overwrite next: never the newer one.
template <class Read>
[[nodiscard]] std::uint32_t next_slot(ByteView region, Read read) noexcept {
  const auto newest = newest_record(region, read);
  return newest && read(region.first(region.size() / 2)) == newest ? 1 : 0;
}

}  // namespace ecs
