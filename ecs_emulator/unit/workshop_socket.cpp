#include "ecs_emulator/unit/workshop_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace ecs::emulator {
namespace {

constexpr std::size_t kLongestRequest = 1 << 20;
constexpr std::string_view kProgress = "{\"progress\"";

std::string reason() { return std::strerror(errno); }

Result<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.empty() || name.size() >= sizeof(address.sun_path))
    return problem(ProblemKind::usage, "{}: expected a socket name of 1 to {} characters", name,
                   sizeof(address.sun_path) - 1);
  std::copy(name.begin(), name.end(), std::begin(address.sun_path));
  return address;
}

bool connected(int line, const sockaddr_un& address) {
  return ::connect(line, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
}

/// All of the text; false if the other end is gone.
bool send_all(int line, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(line, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      pollfd writable{line, POLLOUT, 0};
      if (::poll(&writable, 1, 5000) <= 0) return false;
      continue;
    }
    if (sent <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace

WorkshopSocket::WorkshopSocket(Descriptor listener, std::filesystem::path path)
    : listener_(std::move(listener)), path_(std::move(path)) {}

WorkshopSocket::~WorkshopSocket() {
  if (listener_.get() >= 0) ::unlink(path_.c_str());
}

Result<WorkshopSocket> WorkshopSocket::listen_at(const std::filesystem::path& path) {
  ECS_TRY(address, address_of(path));
  Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (connected(probe.get(), address))
    return problem(ProblemKind::output, "{}: another workshop listens here", path.string());
  std::error_code ignored;
  if (std::filesystem::is_socket(path, ignored)) ::unlink(path.c_str());
  Descriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (listener.get() < 0 || ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      ::listen(listener.get(), 8) != 0)
    return problem(ProblemKind::output, "{}: cannot listen here: {}", path.string(), reason());
  return WorkshopSocket(std::move(listener), path);
}

std::vector<pollfd> WorkshopSocket::poll_fds() const {
  std::vector<pollfd> fds{{listener_.get(), POLLIN, 0}};
  for (const Visitor& visitor : visitors_) fds.push_back({visitor.line.get(), POLLIN, 0});
  return fds;
}

void WorkshopSocket::let_in() {
  for (;;) {
    const int line = ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (line < 0) return;
    visitors_.push_back({Descriptor(line), {}, false});
  }
}

void WorkshopSocket::hear(Visitor& visitor) {
  std::array<char, 4096> piece{};
  for (;;) {
    const ssize_t got = ::recv(visitor.line.get(), piece.data(), piece.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      visitor.gone = errno != EAGAIN && errno != EWOULDBLOCK;
      return;
    }
    if (got == 0 || visitor.received.size() > kLongestRequest) {
      visitor.gone = true;
      return;
    }
    visitor.received.append(piece.data(), static_cast<std::size_t>(got));
  }
}

void WorkshopSocket::answer(Visitor& visitor, const WorkshopHandler& handler) {
  for (std::size_t end = visitor.received.find('\n'); end != std::string::npos; end = visitor.received.find('\n')) {
    const std::string request = visitor.received.substr(0, end);
    visitor.received.erase(0, end + 1);
    const int line = visitor.line.get();
    const auto report = [line](const std::string& progress) { (void)send_all(line, progress + "\n"); };
    served_ = line;
    if (!send_all(line, handler(request, report) + "\n")) visitor.gone = true;
    served_ = -1;
  }
}

bool WorkshopSocket::visitor_left() const {
  pollfd line{served_, 0, 0};
  return served_ >= 0 && ::poll(&line, 1, 0) == 1 && (line.revents & (POLLHUP | POLLERR)) != 0;
}

void WorkshopSocket::serve_ready(const WorkshopHandler& handler) {
  let_in();
  for (Visitor& visitor : visitors_) {
    hear(visitor);
    answer(visitor, handler);
  }
  std::erase_if(visitors_, [](const Visitor& visitor) { return visitor.gone; });
}

Result<std::string> ask_workshop(const std::filesystem::path& socket, const std::string& request,
                                 const std::function<void(const std::string&)>& report) {
  ECS_TRY(address, address_of(socket));
  const Descriptor line(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!connected(line.get(), address))
    return problem(ProblemKind::link,
                   "{}: no workshop listens here ({}); start one with `ecs-emulator serve --workshop {}`",
                   socket.string(), reason(), socket.string());
  if (!send_all(line.get(), request + "\n")) return problem(ProblemKind::link, "the workshop closed the connection");
  std::string received;
  std::array<char, 4096> piece{};
  for (;;) {
    for (std::size_t end = received.find('\n'); end != std::string::npos; end = received.find('\n')) {
      const std::string text = received.substr(0, end);
      received.erase(0, end + 1);
      if (!text.starts_with(kProgress)) return text;
      if (report) report(text);
    }
    const ssize_t got = ::recv(line.get(), piece.data(), piece.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return problem(ProblemKind::link, "the workshop closed the connection before it answered");
    received.append(piece.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace ecs::emulator
