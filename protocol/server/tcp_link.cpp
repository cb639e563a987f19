// Modbus TCP, on the loopback interface unless asked otherwise, a few connections at once.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "protocol/line/frame_cut.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/server/server_link.hpp"

namespace ecs::protocol {

namespace {

constexpr std::chrono::milliseconds kIdle{100};  ///< a host at work asks more often

struct Connection {
  Descriptor socket;
  std::vector<std::uint8_t> heard;
  ReplyChannel channel;
  std::chrono::steady_clock::time_point asked;  ///< when it was made, or asked last
  bool admitted = false;                        ///< has shown the token, or needs none
  bool ended = false;
  std::uint64_t number = 0;
};

class TcpLink : public ServerLink {
 public:
  TcpLink(FrameCodec codec, const TcpOptions& options, std::vector<std::uint8_t> token, Descriptor listener,
          std::uint16_t port)
      : ServerLink(std::move(codec), Framing::tcp),
        options_(options),
        token_(std::move(token)),
        listener_(std::move(listener)),
        port_(port) {}

  [[nodiscard]] LinkAddress address() const override {
    return {TcpPeer{options_.host, port_, options_.token_file}, options_.unit};
  }
  [[nodiscard]] std::vector<pollfd> poll_fds() const override {
    std::vector<pollfd> fds{{listener_.get(), POLLIN, 0}};
    for (const auto& connection : connections_) fds.push_back({connection.socket.get(), POLLIN, 0});
    return fds;
  }
  [[nodiscard]] std::optional<Clock::time_point> next_deadline() const override {
    std::optional<Clock::time_point> earliest;
    for (const auto& connection : connections_)
      if (const auto next = connection.channel.next()) earliest = earliest ? std::min(*earliest, *next) : *next;
    return earliest;
  }
  std::size_t step(RegisterHandler& handler) override {
    take_newcomers();
    std::size_t answered = 0;
    for (auto& connection : connections_) {
      listen(connection);
      answered += answer(connection, handler);
      speak(connection);
    }
    std::erase_if(connections_, [](const Connection& connection) { return connection.ended; });
    return answered;
  }

 private:
  /// Beyond the most connections the one that has asked nothing for longest gives way; where all have asked within
  /// kIdle, the newcomer is closed.
  void take_newcomers() {
    while (true) {
      Descriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (!socket) return;
      const int on = 1;
      (void)::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      if (connections_.size() >= options_.most_connections) drop_idle();
      if (connections_.size() < options_.most_connections)
        connections_.push_back({std::move(socket), {}, {}, Clock::now(), token_.empty(), false, next_connection()});
    }
  }
  void drop_idle() {
    const auto idle = std::min_element(connections_.begin(), connections_.end(),
                                       [](const Connection& a, const Connection& b) { return a.asked < b.asked; });
    if (idle != connections_.end() && Clock::now() - idle->asked > kIdle) connections_.erase(idle);
  }

  static void listen(Connection& connection) {
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t got = ::recv(connection.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got > 0) connection.heard.insert(connection.heard.end(), bytes.begin(), bytes.begin() + got);
    connection.ended = got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
  }

  std::size_t answer(Connection& connection, RegisterHandler& handler) {
    std::size_t answered = 0;
    while (!connection.ended) {
      const TcpCut cut = tcp_request_length(connection.heard);
      connection.ended = cut.broken;
      if (cut.broken || cut.length == 0 || connection.heard.size() < cut.length) break;
      const auto frame = std::span<const std::uint8_t>(connection.heard).first(cut.length);
      if (connection.admitted)
        carry_out(frame, handler, connection.number, connection.channel, Clock::now(), {});
      else
        admit(connection, frame);
      connection.asked = Clock::now();
      connection.heard.erase(connection.heard.begin(),
                             connection.heard.begin() + static_cast<std::ptrdiff_t>(cut.length));
      ++answered;
    }
    return answered;
  }

  /// The first frame of a connection must show the token; anything else ends it, without an answer.
  void admit(Connection& connection, std::span<const std::uint8_t> frame) const {
    constexpr std::size_t kPdu = 7, kDigest = kPdu + 6, kReply = kPdu + 5;
    const std::array<std::uint8_t, 6> head{0x10, kToken.first >> 8, kToken.first & 0xFF,
                                           0,    kToken.count,      static_cast<std::uint8_t>(2 * kToken.count)};
    connection.admitted = frame.size() == kDigest + token_.size() &&
                          std::equal(head.begin(), head.end(), frame.begin() + kPdu) &&
                          std::equal(token_.begin(), token_.end(), frame.begin() + kDigest);
    connection.ended = !connection.admitted;
    if (!connection.admitted) return;
    std::vector<std::uint8_t> reply(frame.begin(), frame.begin() + kReply);
    reply[4] = 0;
    reply[5] = kReply - 6;
    connection.channel.put(std::move(reply), Clock::now(), {});
  }

  static void speak(Connection& connection) {
    while (const auto bytes = connection.channel.take_due(Clock::now()))
      if (::send(connection.socket.get(), bytes->data(), bytes->size(), MSG_DONTWAIT | MSG_NOSIGNAL) !=
          static_cast<ssize_t>(bytes->size()))
        connection.ended = true;
  }

  TcpOptions options_;
  std::vector<std::uint8_t> token_;  ///< its digest; empty: none is asked for
  Descriptor listener_;
  std::uint16_t port_;
  std::vector<Connection> connections_;
};

tl::unexpected<Problem> listen_problem(const TcpOptions& options) {
  return problem(ProblemKind::output,
                 fmt::format("cannot listen on {}:{}: {}", options.host, options.port, std::strerror(errno)));
}

}  // namespace

Result<std::unique_ptr<ServerLink>> open_tcp_link(const TcpOptions& options) {
  std::vector<std::uint8_t> token;
  if (options.token_file.empty() && !is_loopback(options.host))
    return problem(ProblemKind::usage, fmt::format("{}: beyond this computer a token is needed", options.host));
  if (!options.token_file.empty()) {
    ECS_TRY(digest, token_digest_of(options.token_file));
    token = std::move(digest);
  }
  Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener) return listen_problem(options);
  const int on = 1;
  (void)::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  if (::inet_pton(AF_INET, options.host.c_str(), &place.sin_addr) != 1)
    return problem(ProblemKind::usage, fmt::format("{}: expected an IPv4 address such as 0.0.0.0", options.host));
  place.sin_port = htons(options.port);
  socklen_t size = sizeof place;
  auto* const general = reinterpret_cast<sockaddr*>(&place);
  constexpr int kWaiting = 8;
  if (::bind(listener.get(), general, size) != 0 || ::listen(listener.get(), kWaiting) != 0 ||
      ::getsockname(listener.get(), general, &size) != 0)
    return listen_problem(options);
  ECS_TRY(codec, FrameCodec::make(Framing::tcp, options.unit));
  return std::make_unique<TcpLink>(std::move(codec), options, std::move(token), std::move(listener),
                                   ntohs(place.sin_port));
}

}  // namespace ecs::protocol
