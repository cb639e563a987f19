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

}  // namespace ecs
