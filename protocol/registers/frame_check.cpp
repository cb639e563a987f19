// The CRC-16 of Modbus RTU, bit by bit: a frame is short.
#include "protocol/registers/frame_check.hpp"

namespace ecs::protocol {

std::uint16_t crc16_of(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? (crc >> 1) ^ 0xA001u : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

bool crc_agrees(std::span<const std::uint8_t> frame) {
  if (frame.size() < 4) return false;
  const auto body = frame.first(frame.size() - 2);
  return crc16_of(body) == frame[body.size()] + (frame[body.size() + 1] << 8);
}

}  // namespace ecs::protocol
