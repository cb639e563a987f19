// How a stretch of an image travels: each block as it is, or in the shortest of the modes that the unit decodes
// (core/block_code.hpp), and the frames that bring the blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/block_code.hpp"
#include "protocol/registers/unit_data.hpp"

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

/// One frame of a window.
struct BlockFrame {
  std::uint16_t number = 0;           ///< as it travels: the first block, in a coded window with their count less one
  std::uint64_t blocks = 0;           ///< bit n: block n is in it
  std::vector<std::uint8_t> payload;  ///< at most 240 bytes
  std::size_t bytes = 0;              ///< of the image that it brings
};

/// A stretch of memory with the frames that bring it.
struct WindowFrames {
  Address address = 0;
  std::span<const std::uint8_t> bytes;  ///< that memory holds afterwards
  bool coded = false;
  std::vector<BlockFrame> frames;
};

/// Bytes as they are. @pre 1 … kWindowBytes bytes
[[nodiscard]] WindowFrames plain_window(Address address, std::span<const std::uint8_t> bytes);

/// The stretch [from, to) of an image, in as many windows as it takes; coded where that is shorter.
/// @param bank  where the first byte of the image lies
[[nodiscard]] std::vector<WindowFrames> windows_of(Address bank, std::span<const std::uint8_t> image, std::size_t from,
                                                   std::size_t to);

/// Bytes on the wire, reply and gaps included.
[[nodiscard]] std::size_t wire_bytes(const WindowFrames& window);

}  // namespace ecs::protocol
