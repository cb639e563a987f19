// The server as the event loop sees it.
#include "protocol/server/server.hpp"

#include <algorithm>
#include <atomic>

#include <unistd.h>

#include "protocol/server/server_link.hpp"

namespace ecs::protocol {

namespace {

/// Which faults can act where the frames carry no CRC.
bool acts_without_crc(LinkFault fault) {
  return fault == LinkFault::no_reply || fault == LinkFault::lost_request || fault == LinkFault::slow_reply ||
         fault == LinkFault::stale_reply;
}

timespec timespec_of(std::chrono::nanoseconds span) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(span);
  return {static_cast<time_t>(seconds.count()), static_cast<long>((span - seconds).count())};
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    if (fd_ >= 0) ::close(fd_);
    fd_ = other.release();
  }
  return *this;
}

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

std::uint64_t ServerLink::next_connection() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

void ServerLink::carry_out(std::span<const std::uint8_t> frame, RegisterHandler& handler, std::uint64_t connection,
                           ReplyChannel& channel, Clock::time_point request_end, const WirePace& pace) {
  if (framing_ == Framing::rtu && !codec_.is_for_unit(frame)) return;
  const auto drawn = faults.draw();
  const bool spoils = drawn.has_value() && (framing_ == Framing::rtu || acts_without_crc(*drawn));
  if (spoils && *drawn == LinkFault::lost_request) return;
  if (codec_.is_for_unit(frame)) last_request = Clock::now();
  handler.arrives_on(connection);
  auto reply = codec_.answer(frame, handler);
  if (reply.empty() || handler.silent()) return;
  const auto start = std::max(Clock::now(), request_end + pace.gap);
  if (spoils)
    channel.put_spoilt(std::move(reply), start, pace.byte_time, *drawn, faults);
  else
    channel.put(std::move(reply), start, pace.byte_time);
}

ModbusServer::ModbusServer(std::unique_ptr<ServerLink> link) : link_(std::move(link)) {}
ModbusServer::ModbusServer(ModbusServer&&) noexcept = default;
ModbusServer& ModbusServer::operator=(ModbusServer&&) noexcept = default;
ModbusServer::~ModbusServer() = default;

Result<ModbusServer> ModbusServer::on_pty(const PtyOptions& options) {
  return open_pty_link(options).map([](std::unique_ptr<ServerLink>&& link) { return ModbusServer(std::move(link)); });
}

Result<ModbusServer> ModbusServer::on_tcp(const TcpOptions& options) {
  return open_tcp_link(options).map([](std::unique_ptr<ServerLink>&& link) { return ModbusServer(std::move(link)); });
}

LinkAddress ModbusServer::address() const { return link_->address(); }
std::vector<pollfd> ModbusServer::poll_fds() const { return link_->poll_fds(); }
std::optional<ModbusServer::Clock::time_point> ModbusServer::next_deadline() const { return link_->next_deadline(); }
LinkFaults& ModbusServer::faults() { return link_->faults; }
std::optional<ModbusServer::Clock::time_point> ModbusServer::last_request() const { return link_->last_request; }

std::size_t ModbusServer::serve_ready(RegisterHandler& handler, std::chrono::milliseconds timeout) {
  std::chrono::nanoseconds wait = timeout;
  if (const auto deadline = link_->next_deadline())
    wait = std::clamp<std::chrono::nanoseconds>(*deadline - Clock::now(), std::chrono::nanoseconds(0), wait);
  auto fds = link_->poll_fds();
  const timespec limit = timespec_of(wait);
  (void)::ppoll(fds.data(), fds.size(), &limit, nullptr);
  return link_->step(handler);
}

}  // namespace ecs::protocol
