// Where a unit is: the text that names a link, the times that follow from its speed, and what can go wrong with it, in
// kinds that a program may act on (the messages: protocol/client/link.cpp).
// Does not live here: the link itself (protocol/client/link.hpp); `emulator:` addresses, which start a program
// (commissioning/link).
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.hpp"

namespace ecs::protocol {

/// What the last problem of a link was. Each has a message of its own.
enum class LinkFailure {
  none,
  no_such_port,  ///< or no such host
  no_permission,
  not_a_serial_port,
  port_in_use,
  no_connection,  ///< TCP refused or not reachable
  no_answer,
  garbled,    ///< bad CRC, or a reply that is no reply to the request
  stale,      ///< only late replies to earlier requests
  exception,  ///< the unit answered with a Modbus exception
  disconnected,
  cancelled,
};

/// An RS-232, RS-485 or pseudo-terminal port. RTU always has 8 data bits.
struct SerialPort {
  std::string device;
  int baud = 115'200;
  char parity = 'N';  ///< N, E or O
  int stop_bits = 1;  ///< 1 or 2
  friend bool operator==(const SerialPort&, const SerialPort&) = default;
};

struct TcpPeer {
  std::string host;
  std::uint16_t port = 502;
  std::string token_file{};  ///< holds the token that the unit asks for; empty: none
  friend bool operator==(const TcpPeer&, const TcpPeer&) = default;
};

inline constexpr int kDefaultUnit = 1;

struct LinkAddress {
  std::variant<SerialPort, TcpPeer> endpoint;
  int unit = kDefaultUnit;  ///< Modbus unit number, 1 … 247
  [[nodiscard]] bool is_serial() const { return std::holds_alternative<SerialPort>(endpoint); }
  friend bool operator==(const LinkAddress&, const LinkAddress&) = default;
};

/// `rtu:DEVICE:BAUD[:FORMAT[:UNIT]]` or `tcp:HOST:PORT[:UNIT][?token=FILE]`, for example
/// `rtu:/dev/ttyUSB0:115200:8N1:1`. DEVICE may hold colons; an IPv6 HOST is written in brackets. Anything else is a
/// `usage` problem that says what was expected.
[[nodiscard]] Result<LinkAddress> link_address_of(std::string_view text);

/// This computer: "localhost", "127.…", "::1".
[[nodiscard]] bool is_loopback(const std::string& host);

/// The SHA-256 of the token in a file, without blanks and line ends at its ends; what is sent for it. A file that
/// cannot be read or holds no token is a `bad_input` problem.
[[nodiscard]] Result<std::vector<std::uint8_t>> token_digest_of(const std::string& file);

/// The full form, as link_address_of reads it.
[[nodiscard]] std::string to_text(const LinkAddress& address);

/// Every time and count of a link; one place.
struct LinkTiming {
  using Span = std::chrono::nanoseconds;
  Span byte_time{};         ///< one character on the wire; 0 for TCP
  Span frame_gap{};         ///< silence between frames: 3.5 characters, 1.75 ms above 19,200 baud
  Span response_timeout{};  ///< from the request to the first byte of its reply, both frames on the wire included
  Span byte_timeout{};      ///< between two bytes of one reply; well below the response time-out
  Span quiet_time{};        ///< silence after an error: longer than the slowest late reply
  Span connect_timeout{};
  int tries = 4;  ///< of one request, the first included
};
[[nodiscard]] LinkTiming timing_of(const LinkAddress& address);

}  // namespace ecs::protocol
