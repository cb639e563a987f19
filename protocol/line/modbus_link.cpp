// libmodbus on the client's side: the port opened and locked, or why it cannot be had; connect, send, receive, close.
#include "protocol/line/modbus_link.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <modbus.h>
#include <netdb.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "protocol/registers/register_map.hpp"

namespace ecs::protocol {
namespace {

/// "pid 1234 (name)" of the process that holds a lock on this file, from /proc/locks; empty if unknown.
std::string holder_of(int fd) {
  struct stat file {};
  if (::fstat(fd, &file) != 0) return {};
  const std::string wanted = fmt::format("{:02x}:{:02x}:{}", major(file.st_dev), minor(file.st_dev), file.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, advice, mode, pid, place;
    words >> number >> kind >> advice >> mode >> pid >> place;
    if (kind != "FLOCK" || place != wanted) continue;
    std::string name;
    std::getline(std::ifstream(fmt::format("/proc/{}/comm", pid)), name);
    return name.empty() ? fmt::format("pid {}", pid) : fmt::format("pid {} ({})", pid, name);
  }
  return {};
}

tl::unexpected<PortProblem> open_failed(const std::string& device, int error) {
  switch (error) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
    case ENOTDIR:
      return failed(LinkFailure::no_such_port,
                    fmt::format("{}: no such port; check the cable and the name (ls /dev/serial/by-id)", device));
    case EACCES:
    case EPERM:
      return failed(
          LinkFailure::no_permission,
          fmt::format("{}: no permission to open this port; on most systems its users are in the group dialout",
                      device));
    case EBUSY:
      return failed(LinkFailure::port_in_use, fmt::format("{}: another program uses this port", device));
    case EISDIR:
      return failed(LinkFailure::not_a_serial_port, fmt::format("{}: this is a folder, not a serial port", device));
    default:
      return failed(LinkFailure::no_such_port, fmt::format("{}: cannot open: {}", device, std::strerror(error)));
  }
}

}  // namespace

tl::unexpected<PortProblem> failed(LinkFailure failure, std::string message) {
  return tl::unexpected(PortProblem{failure, problem(ProblemKind::link, std::move(message)).value()});
}

tl::expected<Descriptor, PortProblem> lock_port(const std::string& device) {
  Descriptor port(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port) return open_failed(device, errno);
  if (::isatty(port.get()) == 0)
    return failed(LinkFailure::not_a_serial_port, fmt::format("{}: this is not a serial port", device));
  if (::flock(port.get(), LOCK_EX | LOCK_NB) != 0) {
    const std::string holder = holder_of(port.get());
    return failed(LinkFailure::port_in_use,
                  fmt::format("{}: in use by {}; end it first", device, holder.empty() ? "another program" : holder));
  }
  return port;
}

namespace {

constexpr auto kCancelSlice = std::chrono::milliseconds(50);
constexpr auto kShortestNap = std::chrono::microseconds(100);
constexpr int kPatience = 3;  ///< times as long as a reply takes, for one whose bytes keep coming

struct Parts {
  std::uint32_t s = 0;
  std::uint32_t us = 0;
};

Parts parts_of(std::chrono::nanoseconds span) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(span).count();
  return {static_cast<std::uint32_t>(us / 1'000'000), static_cast<std::uint32_t>(us % 1'000'000)};
}

bool host_is_known(const TcpPeer& peer) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int rc = ::getaddrinfo(peer.host.c_str(), nullptr, &hints, &found);
  if (rc == 0) ::freeaddrinfo(found);
  return rc == 0;
}

bool is_link_lost(int error) {
  constexpr std::array kLost{EIO, ECONNRESET, EPIPE, EBADF, ENXIO, ENODEV, ECONNABORTED, ENOTCONN, ECONNREFUSED};
  return std::find(kLost.begin(), kLost.end(), error) != kLost.end();
}

}  // namespace

tl::expected<void, PortProblem> ModbusLink::connect() {
  disconnect();
  if (const auto* serial = std::get_if<SerialPort>(&address_.endpoint)) return connect_serial(*serial);
  return connect_tcp(std::get<TcpPeer>(address_.endpoint));
}

void ModbusLink::disconnect() {
  if (context_ != nullptr) {
    modbus_close(context_);
    modbus_free(context_);
    context_ = nullptr;
  }
  lock_ = Descriptor();
}

tl::expected<void, PortProblem> ModbusLink::connect_serial(const SerialPort& port) {
  ECS_TRY(lock, lock_port(port.device));
  lock_ = std::move(lock);
  context_ = modbus_new_rtu(port.device.c_str(), port.baud, port.parity, 8, port.stop_bits);
  if (prepare()) return {};
  const int error = errno;
  if (context_ != nullptr) modbus_free(context_);
  context_ = nullptr;
  lock_ = Descriptor();
  return failed(LinkFailure::no_such_port, fmt::format("{}: cannot set up this port for {} baud: {}", port.device,
                                                       port.baud, modbus_strerror(error)));
}

tl::expected<void, PortProblem> ModbusLink::connect_tcp(const TcpPeer& peer) {
  if (!host_is_known(peer)) return failed(LinkFailure::no_such_port, fmt::format("{}: no such host", peer.host));
  if (peer.token_file.empty() && !is_loopback(peer.host))
    return failed(LinkFailure::no_permission,
                  fmt::format("{}: TCP beyond this computer needs the token of the unit: tcp:{}:{}:{}?token=FILE",
                              peer.host, peer.host, peer.port, address_.unit));
  context_ = modbus_new_tcp_pi(peer.host.c_str(), std::to_string(peer.port).c_str());
  if (prepare()) return peer.token_file.empty() ? tl::expected<void, PortProblem>() : show_token(peer);
  const int error = errno;
  if (context_ != nullptr) modbus_free(context_);
  context_ = nullptr;
  return failed(LinkFailure::no_connection,
                fmt::format("{}:{}: cannot connect: {}; check that the unit is on and the port is right", peer.host,
                            peer.port, modbus_strerror(error)));
}

/// Before all else, where the unit asks for it.
tl::expected<void, PortProblem> ModbusLink::show_token(const TcpPeer& peer) {
  const auto digest = token_digest_of(peer.token_file);
  if (!digest) return tl::unexpected(PortProblem{LinkFailure::no_permission, digest.error()});
  Bytes pdu{
      MODBUS_FC_WRITE_MULTIPLE_REGISTERS, kToken.first >> 8, kToken.first & 0xFF, 0, kToken.count, 2 * kToken.count};
  pdu.insert(pdu.end(), digest->begin(), digest->end());
  constexpr std::size_t kReply = 5;
  const auto sent = send(pdu);
  const auto reply = sent ? receive(kReply, [] { return false; }) : tl::unexpected(sent.error());
  if (reply && (*reply)[0] == MODBUS_FC_WRITE_MULTIPLE_REGISTERS) return {};
  const bool takes_none = reply.has_value();
  disconnect();
  return failed(LinkFailure::no_permission,
                fmt::format("{}:{}: {}", peer.host, peer.port,
                            takes_none ? "this unit requires no token; omit ?token="
                                       : fmt::format("the unit does not accept the token in {}", peer.token_file)));
}

bool ModbusLink::prepare() {
  if (context_ == nullptr) return false;
  const Parts patience = parts_of(timing_.connect_timeout);
  const Parts response = parts_of(timing_.response_timeout);
  const Parts byte = parts_of(timing_.byte_timeout);
  if (modbus_set_slave(context_, address_.unit) != 0 ||
      modbus_set_error_recovery(context_, MODBUS_ERROR_RECOVERY_NONE) != 0 ||
      modbus_set_response_timeout(context_, patience.s, patience.us) != 0 || modbus_connect(context_) != 0)
    return false;
  modbus_set_response_timeout(context_, response.s, response.us);
  modbus_set_byte_timeout(context_, byte.s, byte.us);
  ::fcntl(modbus_get_socket(context_), F_SETFD, FD_CLOEXEC);
  modbus_flush(context_);
  return true;
}

tl::expected<std::size_t, LinkFailure> ModbusLink::send(std::span<const std::uint8_t> pdu) {
  if (!connected()) return tl::unexpected(LinkFailure::disconnected);
  std::this_thread::sleep_until(last_activity_ + timing_.frame_gap);
  if (modbus_flush(context_) < 0 && is_link_lost(errno)) {
    disconnect();
    return tl::unexpected(LinkFailure::disconnected);
  }
  Bytes request{static_cast<std::uint8_t>(address_.unit)};
  request.insert(request.end(), pdu.begin(), pdu.end());
  const int sent = modbus_send_raw_request(context_, request.data(), static_cast<int>(request.size()));
  last_activity_ = Clock::now();
  if (sent > 0) return static_cast<std::size_t>(sent);
  disconnect();
  return tl::unexpected(LinkFailure::disconnected);
}

ModbusLink::Wait ModbusLink::wait_readable(Clock::time_point until, const std::function<bool()>& cancelled) const {
  while (true) {
    if (cancelled()) return Wait::cancelled;
    const auto left = until - Clock::now();
    if (left <= Clock::duration::zero()) return Wait::over;
    const auto slice = std::chrono::ceil<std::chrono::milliseconds>(std::min<Clock::duration>(left, kCancelSlice));
    pollfd fd{modbus_get_socket(context_), POLLIN, 0};
    const int ready = ::poll(&fd, 1, static_cast<int>(slice.count()));
    if (ready <= 0) continue;
    int unread = 0;  // readable without a byte to read: the other end is gone
    const bool has_bytes = (fd.revents & POLLIN) != 0 && ::ioctl(fd.fd, FIONREAD, &unread) == 0 && unread > 0;
    return has_bytes ? Wait::ready : Wait::lost;
  }
}

/// Until this many bytes have come, or none within the byte time-out. The library's own wait for them cannot be
/// cancelled, and lasts as long as somebody drips bytes.
ModbusLink::Wait ModbusLink::wait_whole(std::size_t bytes, const std::function<bool()>& cancelled) const {
  const auto give_up = Clock::now() + kPatience * (static_cast<int>(bytes) * timing_.byte_time + timing_.byte_timeout);
  std::size_t come = 0;
  for (auto grown = Clock::now(); Clock::now() - grown < timing_.byte_timeout;) {
    if (cancelled()) return Wait::cancelled;
    int unread = 0;
    if (::ioctl(modbus_get_socket(context_), FIONREAD, &unread) != 0) return Wait::lost;
    const auto now = static_cast<std::size_t>(std::max(0, unread));
    if (now >= bytes) return Wait::ready;
    if (Clock::now() > give_up) return Wait::over;
    if (now > come) grown = Clock::now();
    come = now;
    std::this_thread::sleep_for(
        std::clamp<std::chrono::nanoseconds>((bytes - come) * timing_.byte_time, kShortestNap, kCancelSlice));
  }
  return Wait::ready;
}

tl::expected<ModbusLink::Bytes, LinkFailure> ModbusLink::receive(std::size_t bytes,
                                                                 const std::function<bool()>& cancelled) {
  if (!connected()) return tl::unexpected(LinkFailure::disconnected);
  auto wait = wait_readable(Clock::now() + timing_.response_timeout, cancelled);
  if (wait == Wait::ready) {
    wait = wait_whole(bytes + (address_.is_serial() ? 3 : 7), cancelled);
    if (wait == Wait::over) return tl::unexpected(LinkFailure::garbled);
  }
  switch (wait) {
    case Wait::over:
      return tl::unexpected(LinkFailure::no_answer);
    case Wait::cancelled:
      return tl::unexpected(LinkFailure::cancelled);
    case Wait::lost:
      disconnect();
      return tl::unexpected(LinkFailure::disconnected);
    case Wait::ready:
      break;
  }
  std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> frame{};
  const int length = modbus_receive_confirmation(context_, frame.data());
  const int error = errno;
  last_activity_ = Clock::now();
  if (length < 0 && is_link_lost(error)) {
    disconnect();
    return tl::unexpected(LinkFailure::disconnected);
  }
  const bool serial = address_.is_serial();
  const std::size_t head = serial ? 1 : 7;
  const std::size_t tail = serial ? 2 : 0;
  if (length <= static_cast<int>(head + tail) || frame[head - 1] != address_.unit)
    return tl::unexpected(LinkFailure::garbled);
  return Bytes(frame.begin() + static_cast<std::ptrdiff_t>(head),
               frame.begin() + (length - static_cast<std::ptrdiff_t>(tail)));
}

bool ModbusLink::stay_quiet(std::chrono::nanoseconds span, const std::function<bool()>& cancelled) {
  constexpr int kMostExtensions = 2;
  const auto give_up = Clock::now() + kMostExtensions * span;
  auto until = Clock::now() + span;
  while (connected()) {
    const Wait wait = wait_readable(std::min(until, give_up), cancelled);
    if (wait == Wait::lost) disconnect();
    if (wait == Wait::lost || wait == Wait::cancelled) return false;
    if (modbus_flush(context_) < 0 && is_link_lost(errno)) disconnect();
    if (wait == Wait::over) return connected();
    until = Clock::now() + span;
  }
  return false;
}

}  // namespace ecs::protocol
