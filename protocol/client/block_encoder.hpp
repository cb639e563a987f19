// The host's side of coded blocks: each block in the shortest of the modes that the unit decodes (core/block_code.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/block_code.hpp"

namespace ecs::protocol {

/// Bits, high bit first; the last byte is filled with zeros.
class BitWriter {
 public:
  void put(std::uint32_t value, unsigned count);
  [[nodiscard]] std::size_t size() const { return bits_; }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  /// What the other one holds, behind.
  void append(const BitWriter& other);

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t bits_ = 0;
};

/// The block [from, to) of `bytes`. What lies up to 1,024 bytes before it is taken as already decoded.
/// @pre from < to <= bytes.size()
[[nodiscard]] BitWriter coded_block(std::span<const std::uint8_t> bytes, std::size_t from, std::size_t to);

}  // namespace ecs::protocol
