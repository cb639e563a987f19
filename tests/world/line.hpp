// The line of a world, frame by frame: a serial line on which everybody hears everybody, or a connection for each host;
// what its seed lets happen to a frame; and the end of a host, as the client takes it (protocol/line/host_line.hpp).
// Does not live here: libmodbus, ports and sockets (tests/attacks).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/line/host_line.hpp"
#include "tests/world/place.hpp"

namespace ecs::world {

enum class LineFault : std::uint8_t { drop, flip, flip_agreeing, repeat, delay, reorder, cut, silence };
inline constexpr std::size_t kFaults = 8;
inline constexpr std::array<std::string_view, kFaults> kFaultNames{
    "drop", "flip", "flip, CRC agrees", "repeat", "delay", "reorder", "cut", "silence"};

/// Who is on the line: the unit, then hosts and forgers in the order of their coming.
inline constexpr int kUnitEnd = 0;

class HostEnd;

class Line {
 public:
  /// @param shared  a serial line; otherwise every host has a connection of its own
  Line(Schedule& schedule, Random& random, Place& place, bool shared, int baud);

  std::array<double, kFaults> probability{};  ///< of each frame
  std::array<std::uint64_t, kFaults> struck{};
  std::uint64_t frames = 0, collisions = 0;
  /// Every frame as it leaves its sender, before anything happens to it.
  std::function<void(int from, int to, const Bytes& frame)> heard;
  /// A request that has arrived whole, before it is carried out.
  std::function<void(int from, const Bytes& pdu)> arrives;
  /// How long the unit takes to answer.
  Span turnaround{std::chrono::milliseconds(1)};
  Time dead_until{};  ///< nothing passes

  [[nodiscard]] bool shared() const { return shared_; }
  [[nodiscard]] const protocol::LinkAddress& address() const { return address_; }
  [[nodiscard]] Schedule& schedule() { return schedule_; }
  /// A number for whoever joins; `end` may be null: it only sends.
  int join(HostEnd* end);
  void leave(int number) { ends_[static_cast<std::size_t>(number)] = nullptr; }
  /// @param as  in whose place: on a line of its own a frame reaches the unit on the sender's connection
  void send(int from, const Bytes& frame, int as);
  void send(int from, const Bytes& frame) { send(from, frame, from); }
  /// A frame that a host takes for one of the unit.
  void send_to_host(int to, const Bytes& frame);
  /// The next answer of the unit to that host does not leave it: somebody sits between them.
  void withhold_reply_to(int to) { withheld_ = to; }
  /// Every connection is lost; of a shared line, what is under way.
  void cut_all();
  void quiet() { probability = {}, dead_until = {}; }

  [[nodiscard]] static Bytes framed(std::span<const std::uint8_t> pdu);
  /// Without unit number and check; empty: not intact, or not for or of this unit.
  [[nodiscard]] static Bytes unframed(std::span<const std::uint8_t> frame);

 private:
  struct Flight {
    int from = 0;
    int to = 0;  ///< on connections: whose
    Bytes frame;
    bool spoilt = false;  ///< by another one on the line
  };
  void launch(Flight flight);
  void pass(const std::shared_ptr<Flight>& flight, Span later);
  void arrive(const Flight& flight);
  [[nodiscard]] bool strikes(LineFault fault);
  [[nodiscard]] Span time_of(const Bytes& frame) const { return byte_time_ * static_cast<int>(frame.size()); }

  Schedule& schedule_;
  Random& random_;
  Place& place_;
  bool shared_;
  protocol::LinkAddress address_;
  Span byte_time_;
  std::vector<HostEnd*> ends_{nullptr};
  std::shared_ptr<Flight> under_way_;  ///< the last one on a shared line
  Time free_at_{};
  int withheld_ = kUnitEnd;
};

/// A host's end. What its program waits for, the world goes on meanwhile.
class HostEnd final : public protocol::HostLine {
 public:
  /// @param answered_since  of the host: when its last request was sent that was answered
  HostEnd(Line& line, Time& answered_since);
  ~HostEnd() override;
  [[nodiscard]] int number() const { return number_; }

  void hear(const Bytes& bytes);
  void lose_connection();
  void look_up() {
    if (program_ != nullptr) program_->wake();
  }

  [[nodiscard]] tl::expected<void, protocol::PortProblem> connect() override;
  void disconnect() override { connected_ = false; }
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] tl::expected<std::size_t, protocol::LinkFailure> send(std::span<const std::uint8_t> pdu) override;
  [[nodiscard]] tl::expected<Bytes, protocol::LinkFailure> receive(std::size_t bytes,
                                                                   const std::function<bool()>& cancelled) override;
  bool stay_quiet(std::chrono::nanoseconds span, const std::function<bool()>& cancelled) override;
  [[nodiscard]] Clock::time_point now() const override { return line_.schedule().now(); }
  void sleep_until(Clock::time_point time) const override;
  [[nodiscard]] std::int64_t unix_time_s() const override;

 private:
  [[nodiscard]] bool wait_for(std::size_t bytes, Time until, const std::function<bool()>& cancelled);

  Line& line_;
  protocol::LinkTiming timing_;
  int number_;
  Program* program_ = nullptr;  ///< that waits here
  bool connected_ = false;
  Bytes unread_;
  Time last_activity_{};
  Time sent_at_{};
  Time& answered_since_;
};

}  // namespace ecs::world
