// Where a request ends in a stream of bytes (MODBUS over Serial Line V1.02, 2.5.1; MODBUS on TCP/IP V1.0b, 3.1.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace ecs::protocol {

/// Bytes of the RTU request that begins here; nothing: not yet known, or a function whose length is not known.
[[nodiscard]] std::optional<std::size_t> rtu_request_length(std::span<const std::uint8_t> bytes);

struct TcpCut {
  std::size_t length = 0;  ///< of the whole frame; 0: its header is not complete yet
  bool broken = false;     ///< no Modbus: the connection cannot be used any more
};
[[nodiscard]] TcpCut tcp_request_length(std::span<const std::uint8_t> bytes);

}  // namespace ecs::protocol
