// The host's end of a Modbus link: one request, one reply, checked; retried, counted, cancellable. The only place on
// the client's side that knows libmodbus. Does not live here: what the registers mean (client.hpp).
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/result.hpp"
#include "protocol/line/host_line.hpp"
#include "protocol/registers/register_map.hpp"

namespace ecs::protocol {

struct LinkStatistics {
  std::uint64_t requests = 0;  ///< transactions asked for
  std::uint64_t retries = 0;
  std::uint64_t timeouts = 0;
  std::uint64_t crc_errors = 0;       ///< replies with a bad CRC, cut or mixed with garbage
  std::uint64_t stale_replies = 0;    ///< to earlier requests of this link
  std::uint64_t foreign_replies = 0;  ///< to requests that this link never made: another host's
  std::uint64_t exceptions = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t replies = 0;
  double worst_round_trip_ms = 0.0;
  double total_round_trip_ms = 0.0;
  [[nodiscard]] double mean_round_trip_ms() const {
    return replies == 0 ? 0.0 : total_round_trip_ms / static_cast<double>(replies);
  }
};

struct LinkOptions {
  const std::atomic<bool>* cancelled = nullptr;  ///< set by a signal handler or another thread; must outlive the link
  std::optional<LinkTiming> timing;              ///< in place of timing_of(address)
  std::function<std::unique_ptr<HostLine>()> line{};  ///< in place of a port and the computer's clock
};

/// A link to one unit. Destroying it closes and unlocks the port. Not for use from two threads at once.
class Link {
 public:
  [[nodiscard]] static Result<Link> open(const LinkAddress& address, const LinkOptions& options = {});
  Link(Link&&) noexcept;
  Link& operator=(Link&&) noexcept;
  ~Link();

  /// Writes `request` (its first register is the echo cell, filled in here) and reads `answer` (which begins with the
  /// echo) in one transaction, function 23. A reply with another echo is never taken. Echo included in the result.
  [[nodiscard]] Result<Registers> ask(const Block& request, Registers values, const Block& answer);

  /// Writes registers, function 16, one try only: the caller knows by another way what arrived. After a failure the
  /// link has been quiet and is flushed.
  [[nodiscard]] Result<void> write_once(std::uint16_t first, std::span<const std::uint16_t> values);

  /// Opens the same address again after `disconnected`.
  [[nodiscard]] Result<void> reconnect();

  /// False: the cancel flag is not looked at, so that what was started can be taken back after a cancel.
  void heed_cancel(bool heed);
  /// True once the cancel flag is set, if it is heeded.
  [[nodiscard]] bool cancelled() const;
  /// Waits, cancellable. False: cancelled.
  [[nodiscard]] bool pause(std::chrono::nanoseconds span) const;
  /// The clock of the line.
  [[nodiscard]] HostLine::Clock::time_point now() const;
  [[nodiscard]] std::int64_t unix_time_s() const;

  [[nodiscard]] bool connected() const;
  [[nodiscard]] LinkFailure last_failure() const;
  [[nodiscard]] const LinkStatistics& statistics() const;
  [[nodiscard]] const LinkTiming& timing() const;
  [[nodiscard]] const LinkAddress& address() const;

 private:
  struct Connection;
  explicit Link(std::unique_ptr<Connection> connection);
  std::unique_ptr<Connection> connection_;
};

}  // namespace ecs::protocol
