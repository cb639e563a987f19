// Which transaction meets which fault, and when replies go out, whole or with one.
#include "protocol/line/faults.hpp"

#include "tests/support/test.hpp"

using namespace ecs::protocol;
using namespace std::chrono_literals;

namespace {

const ReplyChannel::Bytes kReply{1, 3, 2, 0, 7, 0xF9, 0x86};
const ReplyChannel::Clock::time_point kStart{};

/// What goes out in the end when a reply meets this fault.
std::optional<ReplyChannel::Bytes> reply_with(LinkFault fault) {
  ReplyChannel channel;
  LinkFaults faults;
  channel.put_spoilt(kReply, kStart, 0ns, fault, faults);
  return channel.take_due(kStart + 10s);
}

}  // namespace

TEST_CASE("every fault has a name and is found by it") {
  for (std::size_t k = 0; k < kLinkFaults; ++k) {
    const auto fault = static_cast<LinkFault>(k);
    CHECK(link_fault_named(name_of(fault)) == fault);
  }
  CHECK_FALSE(link_fault_named("no_replies"));
}

TEST_CASE("counted faults come first, in the order of their names, and end with their count") {
  LinkFaults faults;
  faults.next(LinkFault::bad_crc, 1);
  faults.next(LinkFault::no_reply, 2);
  CHECK(faults.draw() == LinkFault::no_reply);
  CHECK(faults.draw() == LinkFault::no_reply);
  CHECK(faults.draw() == LinkFault::bad_crc);
  CHECK_FALSE(faults.draw());
}

TEST_CASE("a fault of probability one in four meets about a quarter, the same for the same seed") {
  LinkFaults faults(5), again(5);
  faults.with_probability(LinkFault::drop_byte, 0.25);
  again.with_probability(LinkFault::drop_byte, 0.25);
  int met = 0;
  for (int k = 0; k < 4000; ++k) {
    const auto drawn = faults.draw();
    CHECK(drawn == again.draw());
    if (drawn) ++met;
  }
  CHECK(met > 850);
  CHECK(met < 1150);
  faults.clear();
  for (int k = 0; k < 100; ++k) CHECK_FALSE(faults.draw());
}

TEST_CASE("the place of a fault is inside the frame") {
  LinkFaults faults;
  for (int k = 0; k < 100; ++k) CHECK(faults.place(7) < 7);
  CHECK(faults.place(1) == 0);
}

TEST_CASE("a paced reply is due when its last byte has passed") {
  ReplyChannel channel;
  channel.put(kReply, kStart, 1ms);
  CHECK(channel.next() == kStart + 7ms);
  CHECK_FALSE(channel.take_due(kStart + 6ms));
  CHECK(channel.take_due(kStart + 7ms) == kReply);
  CHECK_FALSE(channel.next());
}

TEST_CASE("each fault changes the reply in its own way") {
  CHECK(reply_with(LinkFault::bad_crc)->size() == kReply.size());
  CHECK(*reply_with(LinkFault::bad_crc) != kReply);
  CHECK(reply_with(LinkFault::drop_byte)->size() == kReply.size() - 1);
  CHECK(reply_with(LinkFault::cut_tail)->size() < kReply.size());
  CHECK(reply_with(LinkFault::garbage_before)->size() > kReply.size());
  CHECK_FALSE(reply_with(LinkFault::no_reply));
  CHECK(reply_with(LinkFault::slow_reply) == kReply);
}

TEST_CASE("a slow reply is late by slow_ms") {
  ReplyChannel channel;
  LinkFaults faults;
  faults.slow_ms = 40.0;
  channel.put_spoilt(kReply, kStart, 0ns, LinkFault::slow_reply, faults);
  CHECK_FALSE(channel.take_due(kStart + 39ms));
  CHECK(channel.take_due(kStart + 40ms) == kReply);
}

TEST_CASE("a stale reply comes just before the next one") {
  ReplyChannel channel;
  LinkFaults faults;
  channel.put_spoilt(kReply, kStart, 0ns, LinkFault::stale_reply, faults);
  CHECK_FALSE(channel.take_due(kStart + 10s));
  const ReplyChannel::Bytes next{9, 9};
  channel.put(next, kStart + 20s, 0ns);
  ReplyChannel::Bytes out;
  while (const auto due = channel.take_due(kStart + 30s)) out.insert(out.end(), due->begin(), due->end());
  ReplyChannel::Bytes both = kReply;
  both.insert(both.end(), next.begin(), next.end());
  CHECK(out == both);
}
