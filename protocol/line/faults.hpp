// What can go wrong on a link, by name, for the virtual workshop and for tests; and replies on their way to one client:
// when which bytes go out, with these faults applied.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include "protocol/line/frame_codec.hpp"

namespace ecs::protocol {

enum class LinkFault : std::uint8_t {
  no_reply,        ///< the request is carried out, its reply is lost
  lost_request,    ///< the request never arrives
  bad_crc,         ///< one bit of the reply is wrong
  slow_reply,      ///< the reply comes later by slow_ms
  garbage_before,  ///< stray bytes before the reply
  drop_byte,       ///< one byte of the reply is missing
  cut_tail,        ///< the second half of the reply is missing
  stale_reply,     ///< the reply is held back and comes just before the next one
};
inline constexpr std::size_t kLinkFaults = 8;
inline constexpr std::array<std::string_view, kLinkFaults> kLinkFaultNames{
    "no_reply", "lost_request", "bad_crc", "slow_reply", "garbage_before", "drop_byte", "cut_tail", "stale_reply"};
[[nodiscard]] constexpr std::string_view name_of(LinkFault fault) {
  return kLinkFaultNames[static_cast<std::size_t>(fault)];
}
[[nodiscard]] std::optional<LinkFault> link_fault_named(std::string_view name);

/// Decides, reproducibly, which transaction meets which fault. On TCP, which has no CRC of its own, only no_reply,
/// lost_request, slow_reply and stale_reply act.
class LinkFaults {
 public:
  explicit LinkFaults(std::uint32_t seed = 1) : random_(seed) {}

  void next(LinkFault fault, std::uint32_t transactions);  ///< the next n transactions
  void with_probability(LinkFault fault, double probability);
  void clear();

  /// At most one fault for each transaction: a counted one first, in the order of the enum.
  [[nodiscard]] std::optional<LinkFault> draw();
  /// A number below `limit`, for the place of a fault. @pre limit > 0
  [[nodiscard]] std::size_t place(std::size_t limit);

  double slow_ms = 150.0;

 private:
  std::array<std::uint32_t, kLinkFaults> counted_{};
  std::array<double, kLinkFaults> probability_{};
  std::mt19937 random_;
};

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
