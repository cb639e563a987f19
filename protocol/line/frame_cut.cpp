// Lengths of requests from their first bytes.
#include "protocol/line/frame_cut.hpp"

namespace ecs::protocol {

std::optional<std::size_t> rtu_request_length(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2) return std::nullopt;
  switch (bytes[1]) {
    case 1:
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
      return 8;
    case 15:
    case 16:
      return bytes.size() < 7 ? std::nullopt : std::optional<std::size_t>(9u + bytes[6]);
    case 17:
      return 4;
    case 22:
      return 10;
    case 23:
      return bytes.size() < 11 ? std::nullopt : std::optional<std::size_t>(13u + bytes[10]);
    default:
      return std::nullopt;
  }
}

TcpCut tcp_request_length(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHeader = 6;    // transaction, protocol and length
  constexpr std::size_t kShortest = 2;  // unit and function
  constexpr std::size_t kLongest = 254;
  if (bytes.size() < kHeader) return {};
  const std::size_t rest = static_cast<std::size_t>(bytes[4] << 8 | bytes[5]);
  const bool is_modbus = bytes[2] == 0 && bytes[3] == 0 && rest >= kShortest && rest <= kLongest;
  return {kHeader + rest, !is_modbus};
}

}  // namespace ecs::protocol
