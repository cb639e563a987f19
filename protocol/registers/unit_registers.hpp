// Typed values to registers and back, for both ends; the order of the fields is written once, in unit_registers.cpp.
// The blocks of a bulk write, as sender and unit both count and check them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// A value of unit_data.hpp as its block, the echo first; as many registers as the block of register_map.hpp. Text
/// longer than its field is cut; a request block that has a check ends with it; a status is without its pointers.
template <class T>
[[nodiscard]] Registers registers_of(const T& value, std::uint16_t echo);
[[nodiscard]] Registers pointer_registers_of(const UnitStatus& status, std::uint16_t echo);

/// The CRC-32 over the registers between the echo and the last two (high byte first) is what these two hold.
[[nodiscard]] bool check_agrees(std::span<const std::uint16_t> block);

/// Back, from a whole block. A number that its type does not know, a number that is not finite or a text that is not
/// printable is a `link` problem that names the field.
template <class T>
[[nodiscard]] Result<T> value_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<void> take_pointers(std::span<const std::uint16_t> block, UnitStatus& status);

/// Bytes two a register, the first in the high byte; an odd last byte leaves the low byte 0.
[[nodiscard]] Registers packed(std::span<const std::uint8_t> bytes);
/// @pre registers.size() * 2 >= bytes
[[nodiscard]] std::vector<std::uint8_t> unpacked(std::span<const std::uint16_t> registers, std::size_t bytes);

/// Blocks of a window of `length` bytes.
[[nodiscard]] std::size_t blocks_in(std::uint32_t length, std::size_t block_bytes = kBlockBytes);
/// Bytes that block `number` (from 0) of a window of `length` bytes carries; 0: no such block.
[[nodiscard]] std::size_t bytes_in_block(std::uint32_t length, std::size_t number,
                                         std::size_t block_bytes = kBlockBytes);
/// The check of a block: CRC-16 (Modbus) over the window's session, token and tag and the block's number, high byte
/// first, then the payload bytes. A block of another host or staging does not agree, though its header carries neither.
[[nodiscard]] std::uint16_t block_check(const WindowOpen& window, std::uint16_t number,
                                        std::span<const std::uint8_t> payload);

/// Polynomial 0xA001 reflected, start 0xFFFF. On the wire the low byte goes first.
[[nodiscard]] std::uint16_t crc16_of(std::span<const std::uint8_t> bytes);

/// A frame whose last two bytes are the CRC of those before.
[[nodiscard]] bool crc_agrees(std::span<const std::uint8_t> frame);

}  // namespace ecs::protocol
