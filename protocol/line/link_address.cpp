// Reading and writing link addresses; the times of a link (MODBUS over Serial Line V1.02, 2.5.1.1).
#include "protocol/line/link_address.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::protocol {

namespace {

constexpr std::array kBaudRates{1200, 2400, 4800, 9600, 19'200, 38'400, 57'600, 115'200, 230'400, 460'800, 921'600};
constexpr std::string_view kRtuForm = "rtu:DEVICE:BAUD[:8N1[:UNIT]], for example rtu:/dev/ttyUSB0:115200";
constexpr std::string_view kTcpForm =
    "tcp:HOST:PORT[:UNIT][?token=FILE], for example tcp:192.168.0.10:502:1?token=unit.token";

tl::unexpected<Problem> wrong(std::string_view text, std::string_view why, std::string_view form) {
  return problem(ProblemKind::usage, fmt::format("link \"{}\": {}; expected {}", text, why, form));
}

std::optional<int> integer_within(std::string_view text, int least, int most) {
  const bool digits =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  const auto value = digits ? integer_in(text) : std::nullopt;
  if (!value || *value < least || *value > most) return std::nullopt;
  return static_cast<int>(*value);
}

bool looks_like_format(std::string_view text) {
  return text.size() == 3 && text[0] >= '5' && text[0] <= '9' &&
         std::string_view("NEOneo").find(text[1]) != std::string_view::npos;
}

std::string joined(const std::vector<std::string_view>& fields, std::size_t count) {
  return fmt::format("{}", fmt::join(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(count), ":"));
}

Result<void> take_format(SerialPort& port, std::string_view format, std::string_view text) {
  const char parity = static_cast<char>(format[1] & ~0x20);
  if (format[0] != '8') return wrong(text, fmt::format("Modbus RTU needs 8 data bits, got {}", format), kRtuForm);
  if (format[2] != '1' && format[2] != '2')
    return wrong(text, fmt::format("1 or 2 stop bits, got {}", format), kRtuForm);
  port.parity = parity;
  port.stop_bits = format[2] - '0';
  return {};
}

Result<LinkAddress> rtu_address_of(std::string_view text, std::vector<std::string_view> fields) {
  SerialPort port;
  int unit = kDefaultUnit;
  if (fields.size() >= 4 && looks_like_format(fields[fields.size() - 2])) {
    const auto number = integer_within(fields.back(), 1, 247);
    if (!number) return wrong(text, fmt::format("unit number 1 to 247, got \"{}\"", fields.back()), kRtuForm);
    unit = *number;
    fields.pop_back();
  }
  if (fields.size() >= 3 && looks_like_format(fields.back())) {
    ECS_DO(take_format(port, fields.back(), text));
    fields.pop_back();
  }
  if (fields.size() < 2 || fields.front().empty()) return wrong(text, "device or baud rate is missing", kRtuForm);
  const auto baud = integer_within(fields.back(), 1, 10'000'000);
  if (!baud || std::find(kBaudRates.begin(), kBaudRates.end(), *baud) == kBaudRates.end())
    return wrong(text, fmt::format("baud rate one of {}, got \"{}\"", fmt::join(kBaudRates, " "), fields.back()),
                 kRtuForm);
  port.baud = *baud;
  port.device = joined(fields, fields.size() - 1);
  return LinkAddress{port, unit};
}

Result<LinkAddress> tcp_address_of(std::string_view text, std::string_view rest) {
  TcpPeer peer;
  if (const auto at = rest.find('?'); at != std::string_view::npos) {
    constexpr std::string_view kTokenIs = "?token=";
    const std::string_view question = rest.substr(at);
    if (!question.starts_with(kTokenIs) || question.size() == kTokenIs.size())
      return wrong(text, fmt::format("?token=FILE, got \"{}\"", question), kTcpForm);
    peer.token_file = std::string(question.substr(kTokenIs.size()));
    rest = rest.substr(0, at);
  }
  if (rest.starts_with('[')) {
    const auto end = rest.find("]:");
    if (end == std::string_view::npos) return wrong(text, "the host has no ] before its port", kTcpForm);
    peer.host = std::string(rest.substr(1, end - 1));
    rest.remove_prefix(end + 2);
  } else {
    const auto end = rest.find(':');
    if (end == std::string_view::npos) return wrong(text, "the port is missing", kTcpForm);
    peer.host = std::string(rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  const auto fields = split(rest, ':');
  const auto port = integer_within(fields[0], 1, 65'535);
  const auto unit = fields.size() > 1 ? integer_within(fields[1], 1, 247) : std::optional(kDefaultUnit);
  if (peer.host.empty()) return wrong(text, "the host is missing", kTcpForm);
  if (!port) return wrong(text, fmt::format("port 1 to 65535, got \"{}\"", fields[0]), kTcpForm);
  if (fields.size() > 2) return wrong(text, fmt::format("too many fields behind the port: \"{}\"", rest), kTcpForm);
  if (!unit) return wrong(text, fmt::format("unit number 1 to 247, got \"{}\"", rest), kTcpForm);
  peer.port = static_cast<std::uint16_t>(*port);
  return LinkAddress{peer, *unit};
}

}  // namespace

Result<LinkAddress> link_address_of(std::string_view text) {
  if (text.starts_with("rtu:")) return rtu_address_of(text, split(text.substr(4), ':'));
  if (text.starts_with("tcp:")) return tcp_address_of(text, text.substr(4));
  return wrong(text, "unknown kind of link", fmt::format("{}, or {}", kRtuForm, kTcpForm));
}

std::string to_text(const LinkAddress& address) {
  if (const auto* serial = std::get_if<SerialPort>(&address.endpoint))
    return fmt::format("rtu:{}:{}:8{}{}:{}", serial->device, serial->baud, serial->parity, serial->stop_bits,
                       address.unit);
  const auto& peer = std::get<TcpPeer>(address.endpoint);
  const bool is_v6 = peer.host.find(':') != std::string::npos;
  const std::string token = peer.token_file.empty() ? "" : "?token=" + peer.token_file;
  return fmt::format("tcp:{}{}{}:{}:{}{}", is_v6 ? "[" : "", peer.host, is_v6 ? "]" : "", peer.port, address.unit,
                     token);
}

bool is_loopback(const std::string& host) { return host == "localhost" || host == "::1" || host.starts_with("127."); }

Result<std::vector<std::uint8_t>> token_digest_of(const std::string& file) {
  const Unwatched secret;
  ECS_TRY(content, read_file(file));
  const std::string_view token = trimmed(content);
  if (token.empty())
    return problem(ProblemKind::bad_input, fmt::format("{}: expected a token, got an empty file", file));
  const std::string digits = sha256_hex(token);
  std::vector<std::uint8_t> digest;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    digest.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return digest;
}

LinkTiming timing_of(const LinkAddress& address) {
  using namespace std::chrono_literals;
  constexpr auto kUnitTurnaround = 250ms;  // the slowest the unit may be, adapter and scheduling included
  constexpr int kLongestFrame = 256;
  LinkTiming timing;
  timing.connect_timeout = 3s;
  timing.byte_timeout = 40ms;
  const auto* serial = std::get_if<SerialPort>(&address.endpoint);
  if (serial != nullptr) {
    const int bits = 9 + serial->stop_bits + (serial->parity == 'N' ? 0 : 1);
    const double byte_ns = 1e9 * bits / serial->baud;
    timing.byte_time = LinkTiming::Span(std::lround(byte_ns));
    timing.frame_gap = serial->baud > 19'200 ? LinkTiming::Span(1750us) : LinkTiming::Span(std::lround(3.5 * byte_ns));
  }
  timing.response_timeout = kUnitTurnaround + 2 * kLongestFrame * timing.byte_time;
  timing.quiet_time = kUnitTurnaround + 50ms + kLongestFrame * timing.byte_time;
  if (serial == nullptr) timing.response_timeout = 1s;
  return timing;
}

}  // namespace ecs::protocol
