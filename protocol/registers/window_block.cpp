// Counting and checking the blocks of a bulk write.
#include "protocol/registers/window_block.hpp"

#include <algorithm>
#include <vector>

#include "core/bytes.hpp"
#include "protocol/registers/frame_check.hpp"
#include "protocol/registers/register_map.hpp"

namespace ecs::protocol {

std::size_t blocks_in(std::uint32_t length, std::size_t block_bytes) {
  return (length + block_bytes - 1) / block_bytes;
}

std::size_t bytes_in_block(std::uint32_t length, std::size_t number, std::size_t block_bytes) {
  const std::size_t before = number * block_bytes;
  return before >= length ? 0 : std::min(block_bytes, length - before);
}

std::uint16_t block_check(const WindowOpen& window, std::uint16_t number, std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes(12);
  store_big(bytes, 0, window.session);
  store_big(bytes, 4, window.token);
  store_big(bytes, 8, window.tag);
  store_big(bytes, 10, number);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return crc16_of(bytes);
}

}  // namespace ecs::protocol
