// The RAM test of power-up: every location is written and read with two patterns, and gets its content back.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address_map.hpp"

namespace ecs {

/// First address that does not hold what is written to it; nothing if all do.
/// @param memory  has `uint8_t read(Address)` and `void write(Address, uint8_t)`, unprotected while the test runs
template <class Memory>
[[nodiscard]] std::optional<Address> failing_address(Memory& memory, Address first, std::uint32_t size) {
  for (Address address = first; address - first < size; ++address) {
    const std::uint8_t content = memory.read(address);
    bool holds = true;
    for (const std::uint8_t pattern : {std::uint8_t{0x55}, std::uint8_t{0xAA}}) {
      memory.write(address, pattern);
      holds = holds && memory.read(address) == pattern;
    }
    memory.write(address, content);
    if (!holds || memory.read(address) != content) return address;
  }
  return std::nullopt;
}

}  // namespace ecs
