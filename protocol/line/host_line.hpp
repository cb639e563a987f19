// The host's end of a line to one unit, with the time that passes there: what the client needs of either. It is
// libmodbus on a port and the computer's clock (modbus_link.hpp); a test has a line and a clock of its own.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <span>
#include <thread>
#include <vector>

#include <tl/expected.hpp>

#include "base/result.hpp"
#include "protocol/line/link_address.hpp"

namespace ecs::protocol {

/// Why a port cannot be opened, and the message.
struct PortProblem {
  LinkFailure failure = LinkFailure::none;
  Problem problem;
};

class HostLine {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Clock = std::chrono::steady_clock;

  HostLine() = default;
  HostLine(const HostLine&) = delete;
  HostLine& operator=(const HostLine&) = delete;
  virtual ~HostLine() = default;

  [[nodiscard]] virtual tl::expected<void, PortProblem> connect() = 0;
  virtual void disconnect() = 0;
  [[nodiscard]] virtual bool connected() const = 0;

  /// Function code and data, without unit number and check. Keeps the silent gap before it; drops what lies unread.
  /// @return bytes on the line
  [[nodiscard]] virtual tl::expected<std::size_t, LinkFailure> send(std::span<const std::uint8_t> pdu) = 0;

  /// The reply to what was sent, without unit number and check, or no_answer, garbled, disconnected, cancelled.
  /// @param bytes  of a reply that is no exception, in the same form
  [[nodiscard]] virtual tl::expected<Bytes, LinkFailure> receive(std::size_t bytes,
                                                                 const std::function<bool()>& cancelled) = 0;

  /// Listens until nothing has come for `span` (at most twice as long), then drops what came.
  /// False: cancelled or disconnected.
  virtual bool stay_quiet(std::chrono::nanoseconds span, const std::function<bool()>& cancelled) = 0;

  [[nodiscard]] virtual Clock::time_point now() const { return Clock::now(); }
  virtual void sleep_until(Clock::time_point time) const { std::this_thread::sleep_until(time); }
  [[nodiscard]] virtual std::int64_t unix_time_s() const { return std::time(nullptr); }
};

}  // namespace ecs::protocol
