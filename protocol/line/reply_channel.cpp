// Faults that spoil a reply, and the time at which its bytes go out.
#include "protocol/line/reply_channel.hpp"

#include <algorithm>

namespace ecs::protocol {

void ReplyChannel::put(Bytes reply, Clock::time_point start, std::chrono::nanoseconds byte_time) {
  if (!waiting_.empty()) start = std::max(start, waiting_.back().at);
  if (!held_.empty()) {
    start += byte_time * held_.size();
    waiting_.push_back({start, std::move(held_)});
    held_.clear();
  }
  start += byte_time * reply.size();
  waiting_.push_back({start, std::move(reply)});
}

void ReplyChannel::put_spoilt(Bytes reply, Clock::time_point start, std::chrono::nanoseconds byte_time, LinkFault fault,
                              LinkFaults& faults) {
  switch (fault) {
    case LinkFault::no_reply:
    case LinkFault::lost_request:
      return;
    case LinkFault::stale_reply:
      held_ = std::move(reply);
      return;
    case LinkFault::slow_reply:
      start += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(faults.slow_ms));
      break;
    case LinkFault::bad_crc:
      reply[faults.place(reply.size())] ^= static_cast<std::uint8_t>(1u << faults.place(8));
      break;
    case LinkFault::garbage_before: {
      Bytes stray(1 + faults.place(5));
      for (auto& byte : stray) byte = static_cast<std::uint8_t>(faults.place(256));
      reply.insert(reply.begin(), stray.begin(), stray.end());
      break;
    }
    case LinkFault::drop_byte:
      reply.erase(reply.begin() + static_cast<std::ptrdiff_t>(faults.place(reply.size())));
      break;
    case LinkFault::cut_tail:
      reply.resize(reply.size() / 2);
      break;
  }
  put(std::move(reply), start, byte_time);
}

std::optional<ReplyChannel::Bytes> ReplyChannel::take_due(Clock::time_point now) {
  if (waiting_.empty() || waiting_.front().at > now) return std::nullopt;
  Bytes bytes = std::move(waiting_.front().bytes);
  waiting_.pop_front();
  return bytes;
}

std::optional<ReplyChannel::Clock::time_point> ReplyChannel::next() const {
  if (waiting_.empty()) return std::nullopt;
  return waiting_.front().at;
}

}  // namespace ecs::protocol
