#include "commissioning/link/workshop_client.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "commissioning/session/commands.hpp"

namespace ecs::commissioning {
namespace {

constexpr int kLook_ms = 100;  ///< between two looks at the flag

tl::unexpected<Problem> no_link(std::string message) { return problem(ProblemKind::link, std::move(message)); }

/// An open socket.
class Line {
 public:
  Line() : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {}
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] bool connect(const std::string& path) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof(address.sun_path)) {
      errno = ENAMETOOLONG;
      return false;
    }
    path.copy(static_cast<char*>(address.sun_path), path.size());
    return fd_ >= 0 && ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }

  [[nodiscard]] bool send(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t sent = ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// The next line without its end; nothing where the other side closed it or the flag was set.
  [[nodiscard]] std::optional<std::string> line(const std::atomic<bool>& cancelled) {
    for (;;) {
      if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
        std::string text = received_.substr(0, end);
        received_.erase(0, end + 1);
        return text;
      }
      if (cancelled) return std::nullopt;
      pollfd ready{fd_, POLLIN, 0};
      if (::poll(&ready, 1, kLook_ms) <= 0) continue;
      std::array<char, 65536> piece{};
      const ssize_t got = ::recv(fd_, piece.data(), piece.size(), 0);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return std::nullopt;
      received_.append(piece.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  int fd_;
  std::string received_;
};

ProblemKind kind_of(int exit_code) {
  switch (exit_code) {
    case 1:
      return ProblemKind::refused;
    case 2:
      return ProblemKind::usage;
    case 3:
      return ProblemKind::bad_input;
    case 4:
      return ProblemKind::link;
    default:
      return ProblemKind::output;
  }
}

}  // namespace

Result<Json> WorkshopClient::ask(const Json& request, const std::function<void(double)>& progress) const {
  Line line;
  if (!line.connect(socket_.string()))
    return no_link(fmt::format("{}: no workshop listens here ({}); start one with `{}`", socket_.string(),
                               std::strerror(errno),
                               shell_command({"ecs-emulator", "serve", "--workshop", socket_.string()})));
  if (!line.send(one_line(request) + "\n")) return no_link("the workshop closed the connection");
  for (;;) {
    const auto text = line.line(*cancelled_);
    if (!text && *cancelled_) return problem(ProblemKind::refused, "the investigation was stopped");
    if (!text) return no_link("the workshop closed the connection before it answered");
    const Json answer = Json::parse(*text, nullptr, false);
    if (!answer.is_object()) return no_link("the workshop answered something that is no JSON object");
    if (answer.contains("progress")) {
      if (progress) progress(answer.value("progress", 0.0));
      continue;
    }
    if (answer.value("ok", false)) return answer;
    const Json error = answer.value("error", Json::object());
    return problem(kind_of(answer.value("exit", 4)), error.value("message", std::string("refused without a reason")));
  }
}

}  // namespace ecs::commissioning
