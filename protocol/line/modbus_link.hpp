// One connected libmodbus context: a request frame out, the reply frame in. It calls the library only while connected,
// because libmodbus 3.1.6 aborts the process otherwise, and waits by its own poll(), because the library's waits
// cannot be interrupted. A serial port is locked for one program at a time. Does not live here: retries, echo
// (protocol/client/link.hpp).
#pragma once

#include <string>
#include <utility>

#include "base/process.hpp"
#include "protocol/line/host_line.hpp"

struct _modbus;  // libmodbus

namespace ecs::protocol {

/// Opens the device beside the library's own handle, checks that it is a serial port and locks it for this program (an
/// advisory lock on the device) until what comes back is destroyed.
[[nodiscard]] tl::expected<Descriptor, PortProblem> lock_port(const std::string& device);

/// A port that cannot be used, as the answer of the function that opened it.
[[nodiscard]] tl::unexpected<PortProblem> failed(LinkFailure failure, std::string message);

class ModbusLink final : public HostLine {
 public:
  ModbusLink(LinkAddress address, const LinkTiming& timing) : address_(std::move(address)), timing_(timing) {}
  ~ModbusLink() override { ModbusLink::disconnect(); }

  [[nodiscard]] tl::expected<void, PortProblem> connect() override;
  void disconnect() override;
  [[nodiscard]] bool connected() const override { return context_ != nullptr; }
  [[nodiscard]] tl::expected<std::size_t, LinkFailure> send(std::span<const std::uint8_t> pdu) override;
  [[nodiscard]] tl::expected<Bytes, LinkFailure> receive(std::size_t bytes,
                                                         const std::function<bool()>& cancelled) override;
  bool stay_quiet(std::chrono::nanoseconds span, const std::function<bool()>& cancelled) override;

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
  Descriptor lock_;
  _modbus* context_ = nullptr;  ///< exists only while connected
  Clock::time_point last_activity_{};
};

}  // namespace ecs::protocol
