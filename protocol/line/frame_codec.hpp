// One request frame in, one reply frame out, by libmodbus; the same for RTU and TCP.
// Does not live here: where frames begin and end in a stream (frame_cut.hpp), the link (protocol/server/server.cpp).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "protocol/registers/register_handler.hpp"

namespace ecs::protocol {

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
