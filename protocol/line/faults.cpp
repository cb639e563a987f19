// Which transaction meets which fault, what it does to a reply, and when the bytes go out.
#include "protocol/line/faults.hpp"

#include <algorithm>

#include "base/random.hpp"

namespace ecs::protocol {

std::optional<LinkFault> link_fault_named(std::string_view name) {
  for (std::size_t i = 0; i < kLinkFaults; ++i)
    if (kLinkFaultNames[i] == name) return static_cast<LinkFault>(i);
  return std::nullopt;
}

void LinkFaults::next(LinkFault fault, std::uint32_t transactions) {
  counted_[static_cast<std::size_t>(fault)] = transactions;
}

void LinkFaults::with_probability(LinkFault fault, double probability) {
  probability_[static_cast<std::size_t>(fault)] = probability;
}

void LinkFaults::clear() {
  counted_ = {};
  probability_ = {};
}

std::optional<LinkFault> LinkFaults::draw() {
  for (std::size_t i = 0; i < kLinkFaults; ++i) {
    if (counted_[i] == 0) continue;
    --counted_[i];
    return static_cast<LinkFault>(i);
  }
  for (std::size_t i = 0; i < kLinkFaults; ++i)
    if (probability_[i] > 0.0 && chance(random_, probability_[i])) return static_cast<LinkFault>(i);
  return std::nullopt;
}

std::size_t LinkFaults::place(std::size_t limit) { return one_of(random_, static_cast<std::uint32_t>(limit)); }

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
