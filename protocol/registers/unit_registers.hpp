// Typed values to registers and back, for both ends; the order of the fields is written once, in unit_registers.cpp.
// The blocks of a bulk write, as sender and unit both count and check them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "protocol/registers/keys.hpp"
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
/// The keyed check of a block: over the window (session, number, address, length, token, coded), the block's number and
/// the payload bytes. A block of another host, window or staging does not agree, though its header carries none of
/// them.
[[nodiscard]] std::uint64_t block_check(const std::optional<Secret>& key, const WindowOpen& window,
                                        std::uint16_t number, std::span<const std::uint8_t> payload);
/// Of a piece of memory, that a host compares with its own without reading it.
[[nodiscard]] std::uint64_t piece_check(const Secret& key, Address address, std::span<const std::uint8_t> bytes);

/// A request block whose last four registers are the keyed check over all between the echo and them.
[[nodiscard]] Registers sealed(Registers block, Keyed kind, const std::optional<Secret>& key);
[[nodiscard]] bool seal_agrees(std::span<const std::uint16_t> block, Keyed kind, const std::optional<Secret>& key);
/// The keyed check of an answer: over the place of its block, the challenge of who asked, and its registers, the echo
/// included, before the check.
[[nodiscard]] std::uint64_t answer_check(const Secret& key, const Block& block, std::uint32_t challenge,
                                         std::span<const std::uint16_t> answer);
void put_check(Registers& block, std::uint64_t check);
[[nodiscard]] std::uint64_t check_at_end(std::span<const std::uint16_t> block);

/// Polynomial 0xA001 reflected, start 0xFFFF. On the wire the low byte goes first.
[[nodiscard]] std::uint16_t crc16_of(std::span<const std::uint8_t> bytes);

/// A frame whose last two bytes are the CRC of those before.
[[nodiscard]] bool crc_agrees(std::span<const std::uint8_t> frame);

}  // namespace ecs::protocol
