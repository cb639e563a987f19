// The blocks of a bulk write, as sender and unit both count and check them.
// Does not live here: the order of the registers of a block (register_map.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// Blocks of a window of `length` bytes.
[[nodiscard]] std::size_t blocks_in(std::uint32_t length, std::size_t block_bytes = kBlockBytes);
/// Bytes that block `number` (from 0) of a window of `length` bytes carries; 0: no such block.
[[nodiscard]] std::size_t bytes_in_block(std::uint32_t length, std::size_t number,
                                         std::size_t block_bytes = kBlockBytes);
/// The check of a block: CRC-16 (Modbus) over the window's session, token and tag and the block's number, high byte
/// first, then the payload bytes. A block of another host or staging does not agree, though its header carries neither.
[[nodiscard]] std::uint16_t block_check(const WindowOpen& window, std::uint16_t number,
                                        std::span<const std::uint8_t> payload);

}  // namespace ecs::protocol
