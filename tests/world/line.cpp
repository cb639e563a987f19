#include "tests/world/line.hpp"

#include <algorithm>
#include <utility>

#include "base/random.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::world {
namespace {

using namespace std::chrono_literals;
using protocol::LinkFailure;

constexpr std::uint8_t kUnitNumber = 1;
constexpr std::size_t kAround = 3;  ///< unit number and check

Span drawn(Random& random, Span most) { return Span(static_cast<Span::rep>(uniform(random) * double(most.count()))); }

/// Of a reply that begins here, as libmodbus counts; 0: not known yet.
std::size_t reply_length(const Bytes& bytes) {
  if (bytes.size() < 3) return 0;
  if ((bytes[1] & 0x80) != 0) return 5;
  return bytes[1] == 16 || bytes[1] == 6 ? 8 : 5u + bytes[2];
}

}  // namespace

Line::Line(Schedule& schedule, Random& random, Place& place, bool shared, int baud)
    : schedule_(schedule), random_(random), place_(place), shared_(shared) {
  if (shared)
    address_ = {protocol::SerialPort{"/dev/world", baud, 'N', 1}, kUnitNumber};
  else
    address_ = {protocol::TcpPeer{"127.0.0.1", 502}, kUnitNumber};
  byte_time_ = shared ? timing_of(address_).byte_time : Span(1us);
}

int Line::join(HostEnd* end) {
  ends_.push_back(end);
  return static_cast<int>(ends_.size()) - 1;
}

Bytes Line::framed(std::span<const std::uint8_t> pdu) {
  Bytes frame;
  frame.reserve(pdu.size() + kAround);
  frame.push_back(kUnitNumber);
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  const std::uint16_t crc = protocol::crc16_of(frame);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

Bytes Line::unframed(std::span<const std::uint8_t> frame) {
  if (frame.size() <= kAround || frame[0] != kUnitNumber || !protocol::crc_agrees(frame)) return {};
  return {frame.begin() + 1, frame.end() - 2};
}

bool Line::strikes(LineFault fault) {
  const auto which = static_cast<std::size_t>(fault);
  if (probability[which] == 0.0 || !chance(random_, probability[which])) return false;
  ++struck[which];
  return true;
}

void Line::send(int from, const Bytes& frame, int as) {
  if (heard) heard(from, kUnitEnd, frame);
  launch({as, kUnitEnd, frame});
}

void Line::send_to_host(int to, const Bytes& frame) { launch({kUnitEnd, to, frame}); }

void Line::cut_all() {
  if (shared_ && under_way_) under_way_->spoilt = true;
  for (HostEnd* end : ends_)
    if (!shared_ && end != nullptr) end->lose_connection();
}

void Line::launch(Flight flight) {
  ++frames;
  const Time now = schedule_.now();
  const auto on_line = std::make_shared<Flight>(std::move(flight));
  if (shared_) {
    if (now < free_at_ && under_way_) {
      under_way_->spoilt = on_line->spoilt = true;
      ++collisions;
    }
    free_at_ = std::max(free_at_, now + time_of(on_line->frame));
    under_way_ = on_line;
  }
  if (now < dead_until || strikes(LineFault::drop)) return;
  if (strikes(LineFault::silence)) dead_until = now + drawn(random_, 8s);
  if (!shared_ && strikes(LineFault::cut)) {
    const int whose = on_line->from == kUnitEnd ? on_line->to : on_line->from;
    if (ends_[static_cast<std::size_t>(whose)] != nullptr) ends_[static_cast<std::size_t>(whose)]->lose_connection();
    return;
  }
  if (shared_ && strikes(LineFault::cut))
    on_line->frame.resize(1 + one_of(random_, std::uint32_t(on_line->frame.size())));
  if (shared_ && strikes(LineFault::flip))
    on_line->frame[one_of(random_, std::uint32_t(on_line->frame.size()))] ^= std::uint8_t(1U << one_of(random_, 8));
  if (on_line->frame.size() > kAround && strikes(LineFault::flip_agreeing)) {
    Bytes pdu(on_line->frame.begin() + 1, on_line->frame.end() - 2);
    pdu[one_of(random_, std::uint32_t(pdu.size()))] ^= std::uint8_t(1U << one_of(random_, 8));
    on_line->frame = framed(pdu);
  }
  if (strikes(LineFault::repeat)) pass(on_line, drawn(random_, chance(random_, 0.5) ? 20ms : 3s));
  Span later{};
  if (strikes(LineFault::delay)) later = drawn(random_, 4s);
  if (strikes(LineFault::reorder)) later += drawn(random_, 60ms);
  pass(on_line, later);
}

void Line::pass(const std::shared_ptr<Flight>& flight, Span later) {
  schedule_.after(time_of(flight->frame) + later, [this, flight] { arrive(*flight); });
}

void Line::arrive(const Flight& flight) {
  const bool from_unit = flight.from == kUnitEnd;
  for (std::size_t end = 1; end < ends_.size(); ++end) {
    if (ends_[end] == nullptr || static_cast<int>(end) == flight.from) continue;
    if (!shared_ && (!from_unit || flight.to != static_cast<int>(end))) continue;
    if (!flight.spoilt)
      ends_[end]->hear(flight.frame);
    else
      ends_[end]->hear(Bytes(flight.frame.size(), 0));
  }
  if (from_unit || flight.spoilt) return;
  const Bytes pdu = unframed(flight.frame);
  if (pdu.empty()) return;
  if (arrives) arrives(flight.from, pdu);
  const Bytes reply = place_.take(pdu, shared_ ? 1 : std::uint64_t(flight.from),
                                  shared_ ? "serial line" : "127.0.0." + std::to_string(flight.from));
  if (reply.empty()) return;
  schedule_.after(turnaround, [this, to = flight.from, frame = framed(reply)] {
    if (heard) heard(kUnitEnd, to, frame);
    if (std::exchange(withheld_, withheld_ == to ? kUnitEnd : withheld_) == to) return;
    launch({kUnitEnd, to, frame});
  });
}

HostEnd::HostEnd(Line& line, Time& answered_since)
    : line_(line), timing_(timing_of(line.address())), number_(line.join(this)), answered_since_(answered_since) {}
HostEnd::~HostEnd() { line_.leave(number_); }

void HostEnd::hear(const Bytes& bytes) {
  if (!connected_) return;
  unread_.insert(unread_.end(), bytes.begin(), bytes.end());
  look_up();
}

void HostEnd::lose_connection() {
  connected_ = false;
  unread_.clear();
  look_up();
}

void HostEnd::sleep_until(Clock::time_point time) const {
  while (line_.schedule().now() < time) line_.schedule().wait_until(time);
}

std::int64_t HostEnd::unix_time_s() const {
  constexpr std::int64_t kBegin_s = 1'790'000'000;
  return kBegin_s + std::chrono::duration_cast<std::chrono::seconds>(now().time_since_epoch()).count();
}

tl::expected<void, protocol::PortProblem> HostEnd::connect() {
  sleep_until(now() + 1ms);
  if (!line_.shared() && now() < line_.dead_until) {
    sleep_until(now() + timing_.connect_timeout);
    return tl::unexpected(protocol::PortProblem{LinkFailure::no_connection,
                                                problem(ProblemKind::link, "cannot connect: timed out").value()});
  }
  connected_ = true;
  unread_.clear();
  return {};
}

tl::expected<std::size_t, LinkFailure> HostEnd::send(std::span<const std::uint8_t> pdu) {
  if (!connected_) return tl::unexpected(LinkFailure::disconnected);
  sleep_until(last_activity_ + timing_.frame_gap);
  unread_.clear();
  const Bytes frame = Line::framed(pdu);
  last_activity_ = sent_at_ = now();
  line_.send(number_, frame);
  return frame.size();
}

/// Until so many bytes have come. False: the time is over.
bool HostEnd::wait_for(std::size_t bytes, Time until, const std::function<bool()>& cancelled) {
  program_ = line_.schedule().running();
  while (connected_ && unread_.size() < bytes && now() < until && !cancelled()) line_.schedule().wait_until(until);
  program_ = nullptr;
  return unread_.size() >= bytes;
}

tl::expected<Bytes, LinkFailure> HostEnd::receive(std::size_t bytes, const std::function<bool()>& cancelled) {
  if (!connected_) return tl::unexpected(LinkFailure::disconnected);
  const bool begun = wait_for(1, now() + timing_.response_timeout, cancelled);
  while (begun && connected_ && unread_.size() < bytes + kAround && !cancelled()) {
    const std::size_t come = unread_.size();
    if (!wait_for(come + 1, now() + timing_.byte_timeout, cancelled)) break;
  }
  last_activity_ = now();
  if (!connected_) return tl::unexpected(LinkFailure::disconnected);
  if (cancelled()) return tl::unexpected(LinkFailure::cancelled);
  if (!begun) return tl::unexpected(LinkFailure::no_answer);
  const std::size_t length = reply_length(unread_);
  if (length == 0 || unread_.size() < length) return tl::unexpected(LinkFailure::garbled);
  Bytes pdu = Line::unframed(std::span(unread_).first(length));
  if (pdu.empty()) return tl::unexpected(LinkFailure::garbled);
  answered_since_ = sent_at_;
  return pdu;
}

bool HostEnd::stay_quiet(std::chrono::nanoseconds span, const std::function<bool()>& cancelled) {
  const Time give_up = now() + 2 * span;
  Time until = now() + span;
  while (connected_) {
    const bool came = wait_for(1, std::min(until, give_up), cancelled);
    unread_.clear();
    if (!connected_ || cancelled()) return false;
    if (!came) return true;
    until = now() + span;
  }
  return false;
}

}  // namespace ecs::world
