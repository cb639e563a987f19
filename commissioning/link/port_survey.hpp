// What can be learnt about a serial port without talking Modbus: is it there, may it be opened, does it echo.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "protocol/line/link_address.hpp"

namespace ecs::commissioning {

/// Serial ports of this computer: USB adapters and built-in ones that have hardware behind them.
[[nodiscard]] std::vector<std::string> serial_ports();

/// Why the device cannot be opened, in words with what to do; nothing if it can.
struct PortTrouble {
  std::string message;
  std::string action;
};
[[nodiscard]] std::optional<PortTrouble> trouble_with(const std::string& device);

/// Sends one read request, byte by byte as they are, and gives what comes back within half a second.
struct PortAnswer {
  std::vector<std::uint8_t> sent;
  std::vector<std::uint8_t> received;
  [[nodiscard]] bool is_echo() const;  ///< the link returns what is sent
};
[[nodiscard]] Result<PortAnswer> raw_answer(const protocol::SerialPort& line, int unit);

}  // namespace ecs::commissioning
