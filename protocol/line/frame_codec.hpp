// Requests in a stream of bytes: where each ends (MODBUS over Serial Line V1.02, 2.5.1; MODBUS on TCP/IP V1.0b, 3.1.3),
// and one request frame in, one reply frame out, by libmodbus, the same for RTU and TCP. Does not live here: the link
// (protocol/server/server.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "protocol/registers/register_map.hpp"

namespace ecs::protocol {

/// Bytes of the RTU request that begins here; nothing: not yet known, or a function whose length is not known.
[[nodiscard]] std::optional<std::size_t> rtu_request_length(std::span<const std::uint8_t> bytes);

struct TcpCut {
  std::size_t length = 0;  ///< of the whole frame; 0: its header is not complete yet
  bool broken = false;     ///< no Modbus: the connection cannot be used any more
};
[[nodiscard]] TcpCut tcp_request_length(std::span<const std::uint8_t> bytes);

enum class Framing : std::uint8_t { rtu, tcp };

class FrameCodec {
 public:
  [[nodiscard]] static Result<FrameCodec> make(Framing framing, int unit);
  FrameCodec(FrameCodec&&) noexcept;
  FrameCodec& operator=(FrameCodec&&) noexcept;
  ~FrameCodec();

  /// @param frame  whole: with unit number and CRC (RTU) or with its MBAP header (TCP)
  /// @return the reply; empty: none is due (other unit, broadcast, not intact)
  [[nodiscard]] std::vector<std::uint8_t> answer(std::span<const std::uint8_t> frame, RegisterHandler& handler);

  /// Whether the frame is for this unit (broadcast included).
  [[nodiscard]] bool is_for_unit(std::span<const std::uint8_t> frame) const;

 private:
  struct Library;
  explicit FrameCodec(std::unique_ptr<Library> library);
  std::unique_ptr<Library> library_;
};

}  // namespace ecs::protocol
