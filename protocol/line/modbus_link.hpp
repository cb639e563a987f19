// One connected libmodbus context: a request frame out, the reply frame in. It calls the library only while connected,
// because libmodbus 3.1.6 aborts the process otherwise, and waits by its own poll(), because the library's waits
// cannot be interrupted. Does not live here: retries, echo (protocol/client/link.hpp).
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "protocol/line/link_address.hpp"
#include "protocol/line/port_lock.hpp"

struct _modbus;  // libmodbus

namespace ecs::protocol {

class ModbusLink {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Clock = std::chrono::steady_clock;

  ModbusLink(LinkAddress address, const LinkTiming& timing) : address_(std::move(address)), timing_(timing) {}
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;
  ~ModbusLink() { disconnect(); }

  [[nodiscard]] tl::expected<void, PortProblem> connect();
  void disconnect();
  [[nodiscard]] bool connected() const { return context_ != nullptr; }

  /// Function code and data, without unit number and check. Keeps the silent gap before it; drops what lies unread.
  [[nodiscard]] tl::expected<std::size_t, LinkFailure> send(std::span<const std::uint8_t> pdu);

  /// The reply to what was sent, without unit number and check, or no_answer, garbled, disconnected, cancelled.
  /// @param bytes  of a reply that is no exception, in the same form
  [[nodiscard]] tl::expected<Bytes, LinkFailure> receive(std::size_t bytes, const std::function<bool()>& cancelled);

  /// Listens until nothing has come for `span` (at most twice as long), then drops what came.
  /// False: cancelled or disconnected.
  bool stay_quiet(std::chrono::nanoseconds span, const std::function<bool()>& cancelled);

 private:
  enum class Wait { ready, over, lost, cancelled };
  [[nodiscard]] Wait wait_readable(Clock::time_point until, const std::function<bool()>& cancelled) const;
  [[nodiscard]] Wait wait_whole(std::size_t bytes, const std::function<bool()>& cancelled) const;
  [[nodiscard]] tl::expected<void, PortProblem> connect_serial(const SerialPort& port);
  [[nodiscard]] tl::expected<void, PortProblem> connect_tcp(const TcpPeer& peer);
  [[nodiscard]] tl::expected<void, PortProblem> show_token(const TcpPeer& peer);
  [[nodiscard]] bool prepare();

  LinkAddress address_;
  LinkTiming timing_;
  std::optional<PortLock> lock_;
  _modbus* context_ = nullptr;  ///< exists only while connected
  Clock::time_point last_activity_{};
};

}  // namespace ecs::protocol
