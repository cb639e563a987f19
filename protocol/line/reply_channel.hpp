// Replies on their way to one client: when which bytes go out, with the faults of the link applied.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/line/faults.hpp"
#include "protocol/line/frame_codec.hpp"

namespace ecs::protocol {

class ReplyChannel {
 public:
  using Clock = std::chrono::steady_clock;
  using Bytes = std::vector<std::uint8_t>;

  /// @param start      when the first byte may go out
  /// @param byte_time  of one byte on the wire; 0: not paced. A frame is handed over when its last byte has passed
  void put(Bytes reply, Clock::time_point start, std::chrono::nanoseconds byte_time);
  /// The same with one of the faults that spoil a reply.
  void put_spoilt(Bytes reply, Clock::time_point start, std::chrono::nanoseconds byte_time, LinkFault fault,
                  LinkFaults& faults);

  /// What is due by `now`, in order; removed from the channel.
  [[nodiscard]] std::optional<Bytes> take_due(Clock::time_point now);
  [[nodiscard]] std::optional<Clock::time_point> next() const;

 private:
  struct Delivery {
    Clock::time_point at;
    Bytes bytes;
  };
  std::deque<Delivery> waiting_;
  Bytes held_;  ///< by stale_reply, until the next reply
};

}  // namespace ecs::protocol
