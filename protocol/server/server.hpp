// The unit's end of the link: a Modbus server on a pseudo-terminal (RTU) or on TCP, driven by a single-threaded event
// loop; it never blocks longer than asked. Does not live here: what the registers mean (register_server.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <poll.h>

#include "base/result.hpp"
#include "protocol/line/faults.hpp"
#include "protocol/line/link_address.hpp"
#include "protocol/registers/register_map.hpp"

namespace ecs::protocol {

class ServerLink;

struct PtyOptions {
  std::filesystem::path link_path;  ///< symbolic link to make to the pseudo-terminal; empty: none
  int baud = 115'200;               ///< for pacing and for address()
  bool paced = false;               ///< take the time that a wire would: 10 bits a byte, both ways, and the gaps
  int unit = kDefaultUnit;
};

struct TcpOptions {
  std::uint16_t port = 0;  ///< 0: any free one
  int unit = kDefaultUnit;
  std::size_t most_connections = 8;  ///< that have a place
  std::string host = "127.0.0.1";    ///< IPv4 address of the interface; beyond loopback a token is needed
  std::string token_file{};          ///< what every connection must show first; empty: nothing
  std::size_t most_newcomers = 512;  ///< served without a place
};

class ModbusServer {
 public:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] static Result<ModbusServer> on_pty(const PtyOptions& options);
  [[nodiscard]] static Result<ModbusServer> on_tcp(const TcpOptions& options);
  ModbusServer(ModbusServer&&) noexcept;
  ModbusServer& operator=(ModbusServer&&) noexcept;
  ~ModbusServer();  ///< closes the link and removes the symbolic link

  /// What a client opens; with the symbolic link, if there is one.
  [[nodiscard]] LinkAddress address() const;

  /// Descriptors to watch; ask again before every poll().
  [[nodiscard]] std::vector<pollfd> poll_fds() const;
  /// When serve_ready has something to do even if no descriptor is ready (a paced or delayed reply, a byte time-out).
  [[nodiscard]] std::optional<Clock::time_point> next_deadline() const;

  /// Waits up to `timeout` for something to do, then does all there is to do without waiting.
  /// @return requests answered
  std::size_t serve_ready(RegisterHandler& handler, std::chrono::milliseconds timeout);

  [[nodiscard]] LinkFaults& faults();

 private:
  explicit ModbusServer(std::unique_ptr<ServerLink> link);
  std::unique_ptr<ServerLink> link_;
};

}  // namespace ecs::protocol
