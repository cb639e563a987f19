// The CRC-16 of Modbus RTU (MODBUS over Serial Line V1.02, 6.2.2).
#pragma once

#include <cstdint>
#include <span>

namespace ecs::protocol {

/// Polynomial 0xA001 reflected, start 0xFFFF. On the wire the low byte goes first.
[[nodiscard]] std::uint16_t crc16_of(std::span<const std::uint8_t> bytes);

/// A frame whose last two bytes are the CRC of those before.
[[nodiscard]] bool crc_agrees(std::span<const std::uint8_t> frame);

}  // namespace ecs::protocol
