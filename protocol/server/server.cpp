// The server as the event loop sees it, on the two kinds of link that it sits on: RTU on the master side of a
// pseudo-terminal, whose slave side a client opens like a serial port, and Modbus TCP, on the loopback interface unless
// asked otherwise, a few connections at once.
#include "protocol/server/server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>
#include <unordered_map>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/process.hpp"
#include "protocol/line/frame_codec.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

/// How long bytes take on this link.
struct WirePace {
  std::chrono::nanoseconds byte_time{};  ///< 0: not paced
  std::chrono::nanoseconds gap{};        ///< silence between request and reply
};

class ServerLink {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~ServerLink() = default;
  [[nodiscard]] virtual LinkAddress address() const = 0;
  [[nodiscard]] virtual std::vector<pollfd> poll_fds() const = 0;
  [[nodiscard]] virtual std::optional<Clock::time_point> next_deadline() const = 0;
  /// Reads what is there, answers what is complete and due, writes what is due.
  /// @param polled  poll_fds(), after poll()  @return requests answered
  virtual std::size_t step(RegisterHandler& handler, std::span<const pollfd> polled) = 0;

  LinkFaults faults;

 protected:
  ServerLink(FrameCodec codec, Framing framing) : codec_(std::move(codec)), framing_(framing) {}
  /// Carries out one request and puts its reply, spoilt or not, into the channel. The reply begins one gap after
  /// `request_end`, when the request's last byte had passed the wire, or now if that is over.
  /// @param connection  that it came on, from next_connection()
  /// @param origin  the peer's address, or the serial line
  void carry_out(std::span<const std::uint8_t> frame, RegisterHandler& handler, std::uint64_t connection,
                 const std::string& origin, ReplyChannel& channel, Clock::time_point request_end, const WirePace& pace);
  /// A number that no other connection of this program has, on whichever link.
  [[nodiscard]] static std::uint64_t next_connection();

 private:
  FrameCodec codec_;
  Framing framing_;
};

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

std::uint64_t ServerLink::next_connection() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

void ServerLink::carry_out(std::span<const std::uint8_t> frame, RegisterHandler& handler, std::uint64_t connection,
                           const std::string& origin, ReplyChannel& channel, Clock::time_point request_end,
                           const WirePace& pace) {
  if (framing_ == Framing::rtu && !codec_.is_for_unit(frame)) return;
  const auto drawn = faults.draw();
  const bool spoils = drawn.has_value() && (framing_ == Framing::rtu || acts_without_crc(*drawn));
  if (spoils && *drawn == LinkFault::lost_request) return;
  handler.arrives_on(connection, origin);
  auto reply = codec_.answer(frame, handler);
  if (reply.empty() || handler.silent()) return;
  const auto start = std::max(Clock::now(), request_end + pace.gap);
  if (spoils)
    channel.put_spoilt(std::move(reply), start, pace.byte_time, *drawn, faults);
  else
    channel.put(std::move(reply), start, pace.byte_time);
}

namespace {

using namespace std::chrono_literals;

/// So long the loop of a unit waits for its hosts in one period, and for one request more: what is left is answered in
/// the next ones, each connection in its turn.
constexpr auto kServingBudget = 200us;

const std::string kSerialLine = "serial line";

/// Silence that ends a broken request; below the time a client waits before it tries again.
constexpr auto kFrameSilence = 25ms;

/// Where a link leads if that exists and is not `own`: the name of a pseudo-terminal ends with its master side.
std::optional<std::filesystem::path> living_target(const std::filesystem::path& link, const std::string& own) {
  std::error_code error;
  auto target = std::filesystem::canonical(link, error);
  if (error || target == own) return std::nullopt;
  return target;
}

/// "pid 1234 (name)" of a process that has this file open, as far as /proc tells; empty if it does not.
std::string user_of(const std::filesystem::path& file) {
  std::error_code error;
  for (const auto& process : std::filesystem::directory_iterator("/proc", error)) {
    const std::string pid = process.path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
    for (std::filesystem::directory_iterator open(process.path() / "fd", error), end; !error && open != end;
         open.increment(error)) {
      std::error_code closed;
      if (std::filesystem::read_symlink(open->path(), closed) != file) continue;
      std::string name;
      std::getline(std::ifstream(process.path() / "comm"), name);
      return fmt::format("pid {} ({})", pid, name);
    }
  }
  return {};
}

tl::unexpected<Problem> in_use(const std::filesystem::path& link, const std::filesystem::path& target) {
  const std::string user = user_of(target);
  return problem(
      ProblemKind::output,
      user.empty()
          ? fmt::format("{}: this link points to {}; remove it, or give another link", link.string(), target.string())
          : fmt::format("{}: this link points to {}, which {} has open; end that program, or give another link",
                        link.string(), target.string(), user));
}

class PtyLink : public ServerLink {
 public:
  PtyLink(FrameCodec codec, const PtyOptions& options, Descriptor master, Descriptor keeper, std::string slave)
      : ServerLink(std::move(codec), Framing::rtu),
        options_(options),
        master_(std::move(master)),
        keeper_(std::move(keeper)),
        slave_(std::move(slave)) {
    if (!options.paced) return;
    const LinkTiming timing = timing_of(PtyLink::address());
    pace_ = {timing.byte_time, timing.frame_gap};
  }
  ~PtyLink() override {
    std::error_code ignored;
    if (link_made_ && std::filesystem::read_symlink(options_.link_path, ignored) == link_target())
      std::filesystem::remove(options_.link_path, ignored);
  }

  /// A symbolic link that is left over is replaced; one that leads somewhere, or anything else in its place, is not
  /// touched.
  [[nodiscard]] Result<void> make_link() {
    if (options_.link_path.empty()) return {};
    std::error_code error;
    if (std::filesystem::is_symlink(options_.link_path, error)) {
      if (const auto target = living_target(options_.link_path, slave_)) return in_use(options_.link_path, *target);
      std::filesystem::remove(options_.link_path, error);
    }
    std::filesystem::create_symlink(link_target(), options_.link_path, error);
    if (error)
      return problem(ProblemKind::output,
                     fmt::format("cannot make the link {}: {}", options_.link_path.string(), error.message()));
    link_made_ = true;
    return {};
  }

  [[nodiscard]] LinkAddress address() const override {
    return {SerialPort{link_made_ ? options_.link_path.string() : slave_, options_.baud, 'N', 1}, options_.unit};
  }
  [[nodiscard]] std::vector<pollfd> poll_fds() const override { return {{master_.get(), POLLIN, 0}}; }
  [[nodiscard]] std::optional<Clock::time_point> next_deadline() const override {
    auto earliest = channel_.next();
    const auto consider = [&](Clock::time_point time) { earliest = earliest ? std::min(*earliest, time) : time; };
    if (!request_.empty()) consider(request_due_);
    if (request_.empty() && !heard_.empty()) consider(last_heard_ + kFrameSilence);
    return earliest;
  }
  std::size_t step(RegisterHandler& handler, std::span<const pollfd> /*polled*/) override {
    const auto until = Clock::now() + kServingBudget;
    listen();
    std::size_t answered = 0;
    while (cut_request() && Clock::now() >= request_due_ && Clock::now() < until) {
      carry_out(request_, handler, connection_, kSerialLine, channel_, request_due_, pace_);
      request_.clear();
      ++answered;
    }
    speak();
    return answered;
  }

 private:
  void listen() {
    std::array<std::uint8_t, kMostHeard> bytes{};
    const ssize_t got = ::read(master_.get(), bytes.data(), bytes.size());
    if (got <= 0) return;
    last_heard_ = Clock::now();
    if (heard_.empty()) first_heard_ = last_heard_;
    if (heard_.size() + static_cast<std::size_t>(got) > kMostHeard) heard_.clear();
    heard_.insert(heard_.end(), bytes.begin(), bytes.begin() + got);
    looked_through_ = false;
  }

  /// True when `request_` holds a whole request. What was heard and is no request is dropped after a silence, or when a
  /// request for this unit comes behind it: noise in between keeps no host waiting.
  bool cut_request() {
    if (!request_.empty()) return true;
    if (heard_.empty()) return false;
    const auto length = rtu_request_length(heard_);
    if (length && heard_.size() >= *length && crc_agrees(std::span(heard_).first(*length))) return take(*length);
    if (take_behind_noise()) return true;
    if (Clock::now() - last_heard_ < kFrameSilence) return false;
    if (crc_agrees(heard_)) return take(heard_.size());
    heard_.clear();
    return false;
  }
  bool take_behind_noise() {
    if (std::exchange(looked_through_, true)) return false;
    const std::size_t first = heard_.size() > kMostSearched ? heard_.size() - kMostSearched : 1;
    for (std::size_t at = first; at < heard_.size(); ++at) {
      const auto rest = std::span(heard_).subspan(at);
      if (rest.front() != options_.unit) continue;
      const auto length = rtu_request_length(rest);
      if (!length || rest.size() < *length || !crc_agrees(rest.first(*length))) continue;
      heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(at));
      return take(*length);
    }
    return false;
  }
  bool take(std::size_t length) {
    const auto end = heard_.begin() + static_cast<std::ptrdiff_t>(length);
    request_.assign(heard_.begin(), end);
    heard_.erase(heard_.begin(), end);
    request_due_ = first_heard_ + pace_.byte_time * length;
    first_heard_ = request_due_;
    looked_through_ = false;
    return true;
  }

  void speak() {
    while (const auto bytes = channel_.take_due(Clock::now()))
      if (::write(master_.get(), bytes->data(), bytes->size()) < 0) return;
  }

  /// The descriptor of this process that leads to the slave side, and not the slave's own name, which another program's
  /// terminal may have once this process has ended: the link then leads nowhere.
  [[nodiscard]] std::string link_target() const { return fmt::format("/proc/{}/fd/{}", ::getpid(), keeper_.get()); }

  static constexpr std::size_t kMostHeard = 4096;
  static constexpr std::size_t kMostSearched = 512;  ///< two of the longest requests
  PtyOptions options_;
  Descriptor master_;
  Descriptor keeper_;  ///< a slave side of our own: without it the master reads errors while no client has it open
  std::string slave_;
  bool link_made_ = false;
  std::uint64_t connection_ = next_connection();
  WirePace pace_;
  std::vector<std::uint8_t> heard_;
  bool looked_through_ = false;  ///< for a request behind noise, since the last byte came
  Clock::time_point first_heard_{};
  Clock::time_point last_heard_{};
  std::vector<std::uint8_t> request_;  ///< cut, not yet carried out
  Clock::time_point request_due_{};    ///< when its last byte has passed the wire
  ReplyChannel channel_;
};

tl::unexpected<Problem> pty_problem() {
  return problem(ProblemKind::output, fmt::format("cannot make a pseudo-terminal: {}", std::strerror(errno)));
}

constexpr std::size_t kMostTakenIn = 16;  ///< newcomers in one period
constexpr int kWaiting = 512;             ///< connections that the system keeps until they are taken in
constexpr int kManyOfOrigin = 8;
constexpr auto kIdle = 2s;  ///< after which one that only reads gives its place to another one

struct Connection {
  Descriptor socket;
  in_addr_t address = 0;  ///< of the peer
  std::string origin;     ///< the same in words
  std::vector<std::uint8_t> heard;
  ReplyChannel channel;
  std::chrono::steady_clock::time_point asked;  ///< when it was made, or asked last
  bool readable = true;                         ///< as poll() found it; a newcomer may be
  bool admitted = false;                        ///< has shown the token, or needs none
  bool placed = false;                          ///< has one of the places
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
    if (unanswered_) earliest = Clock::now();
    for (const auto& connection : connections_)
      if (const auto next = connection.channel.next()) earliest = earliest ? std::min(*earliest, *next) : *next;
    return earliest;
  }
  std::size_t step(RegisterHandler& handler, std::span<const pollfd> polled) override {
    const auto until = Clock::now() + kServingBudget;
    for (std::size_t i = 0; i < connections_.size(); ++i) connections_[i].readable = polled[i + 1].revents != 0;
    if (polled.front().revents != 0) take_newcomers(until - kServingBudget / 2);
    std::size_t answered = 0, idle = 0;
    for (unanswered_ = false; idle < connections_.size(); unanswered_ = Clock::now() >= until) {
      if (unanswered_) break;
      const bool did = serve(next_in_turn(), handler);
      answered += did ? 1 : 0;
      idle = did ? 0 : idle + 1;
    }
    std::erase_if(connections_, [](const Connection& connection) { return connection.ended; });
    return answered;
  }

 private:
  /// The one after that which was served last.
  Connection& next_in_turn() {
    const auto next = std::partition_point(connections_.begin(), connections_.end(),
                                           [this](const Connection& its) { return its.number <= served_; });
    Connection& its = next == connections_.end() ? connections_.front() : *next;
    served_ = its.number;
    return its;
  }

  /// @return whether it had a request, which is answered now
  bool serve(Connection& connection, RegisterHandler& handler) {
    bool answered = answer(connection, handler);
    if (!answered && connection.readable) {
      listen(connection);
      answered = answer(connection, handler);
    }
    if (answered && connection.admitted && !connection.placed) place(connection, handler);
    speak(connection);
    return answered;
  }

  /// Those without a place, and how many of them each address has.
  struct Newcomers {
    std::size_t count = 0;
    std::unordered_map<in_addr_t, int> of_origin{};
  };
  [[nodiscard]] Newcomers newcomers() const {
    Newcomers all;
    for (const Connection& connection : connections_)
      if (!connection.placed && !connection.ended) ++all.count, ++all.of_origin[connection.address];
    return all;
  }

  /// Answered at once, as long as there are not too many.
  void take_newcomers(Clock::time_point until) {
    std::optional<Newcomers> all;
    for (std::size_t taken = 0; taken < kMostTakenIn && (taken == 0 || Clock::now() < until); ++taken) {
      sockaddr_in peer{};
      socklen_t size = sizeof peer;
      Descriptor socket(
          ::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (!socket) return;
      std::array<char, INET_ADDRSTRLEN> name{};
      (void)::inet_ntop(AF_INET, &peer.sin_addr, name.data(), name.size());
      const int on = 1;
      (void)::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      if (!all) all = newcomers();
      if (all->count >= options_.most_newcomers) make_room(*all);
      connections_.push_back({std::move(socket), peer.sin_addr.s_addr, name.data(), {}, {}, Clock::now()});
      Connection& connection = connections_.back();
      connection.admitted = token_.empty();
      connection.number = next_connection();
      ++all->count, ++all->of_origin[connection.address];
    }
  }

  /// One of those without a place gives way to the next: of an origin that has many of them, else of all, the one that
  /// has asked nothing for longest. A flood of 1,000 a second leaves each half a second between two requests.
  void make_room(Newcomers& all) {
    Connection* yields = nullptr;
    std::pair<int, Clock::time_point> first;
    for (Connection& connection : connections_) {
      if (connection.placed || connection.ended) continue;
      const std::pair rank(-(all.of_origin[connection.address] / kManyOfOrigin), connection.asked);
      if (yields == nullptr || rank < first) yields = &connection, first = rank;
    }
    yields->ended = true;
    --all.count, --all.of_origin[yields->address];
  }

  /// Who has asked gets a place, as soon as one is free or somebody gives way: of the origin that has most places the
  /// one that has asked nothing for longest. Without a place it is one of the newcomers, and is answered all the same.
  void place(Connection& connection, RegisterHandler& handler) {
    std::vector<Connection*> placed;
    for (Connection& other : connections_)
      if (other.placed && !other.ended) placed.push_back(&other);
    connection.placed = placed.size() < options_.most_connections;
    if (connection.placed) return;
    const auto own = handler.speaks_on(connection.number);
    const auto places = [&placed](const std::string& origin) {
      return std::count_if(placed.begin(), placed.end(), [&](const Connection* its) { return its->origin == origin; });
    };
    Connection* yields = nullptr;
    for (Connection* other : placed) {
      const auto its = handler.speaks_on(other->number);
      if (its != RegisterHandler::Speaks::reader && its >= own) continue;
      if (its == own && Clock::now() - other->asked < kIdle) continue;
      const auto rank = std::pair(-places(other->origin), other->asked);
      if (yields == nullptr || rank < std::pair(-places(yields->origin), yields->asked)) yields = other;
    }
    if (yields == nullptr) return;
    yields->placed = false;
    connection.placed = true;
  }

  static void listen(Connection& connection) {
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t got = ::recv(connection.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    connection.readable = got == static_cast<ssize_t>(bytes.size());
    if (got > 0) connection.heard.insert(connection.heard.end(), bytes.begin(), bytes.begin() + got);
    connection.ended = connection.ended || got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
  }

  /// The oldest request that is whole. @return whether there was one
  bool answer(Connection& connection, RegisterHandler& handler) {
    const TcpCut cut = tcp_request_length(connection.heard);
    connection.ended = connection.ended || cut.broken;
    if (connection.ended || cut.length == 0 || connection.heard.size() < cut.length) return false;
    const auto frame = std::span<const std::uint8_t>(connection.heard).first(cut.length);
    if (connection.admitted)
      carry_out(frame, handler, connection.number, connection.origin, connection.channel, Clock::now(), {});
    else
      admit(connection, frame);
    connection.asked = Clock::now();
    connection.heard.erase(connection.heard.begin(),
                           connection.heard.begin() + static_cast<std::ptrdiff_t>(cut.length));
    return true;
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
  std::vector<Connection> connections_;  ///< in the order of their numbers
  std::uint64_t served_ = 0;             ///< number of the one that was served last
  bool unanswered_ = false;              ///< the budget was spent before all requests were answered
};

tl::unexpected<Problem> listen_problem(const TcpOptions& options) {
  return problem(ProblemKind::output,
                 fmt::format("cannot listen on {}:{}: {}", options.host, options.port, std::strerror(errno)));
}

}  // namespace

Result<ModbusServer> ModbusServer::on_pty(const PtyOptions& options) {
  Descriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  if (!master || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0) return pty_problem();
  std::array<char, 128> name{};
  if (::ptsname_r(master.get(), name.data(), name.size()) != 0) return pty_problem();
  Descriptor keeper(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios raw{};
  if (!keeper || ::tcgetattr(keeper.get(), &raw) != 0) return pty_problem();
  ::cfmakeraw(&raw);
  if (::tcsetattr(keeper.get(), TCSANOW, &raw) != 0) return pty_problem();
  ECS_TRY(codec, FrameCodec::make(Framing::rtu, options.unit));
  auto link = std::make_unique<PtyLink>(std::move(codec), options, std::move(master), std::move(keeper), name.data());
  ECS_DO(link->make_link());
  return ModbusServer(std::move(link));
}

Result<ModbusServer> ModbusServer::on_tcp(const TcpOptions& options) {
  std::vector<std::uint8_t> token;
  if (options.token_file.empty() && !is_loopback(options.host))
    return problem(ProblemKind::usage,
                   fmt::format("{} can be reached from other computers: a token is required", options.host));
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
  if (::bind(listener.get(), general, size) != 0 || ::listen(listener.get(), kWaiting) != 0 ||
      ::getsockname(listener.get(), general, &size) != 0)
    return listen_problem(options);
  ECS_TRY(codec, FrameCodec::make(Framing::tcp, options.unit));
  return ModbusServer(std::make_unique<TcpLink>(std::move(codec), options, std::move(token), std::move(listener),
                                                ntohs(place.sin_port)));
}

ModbusServer::ModbusServer(std::unique_ptr<ServerLink> link) : link_(std::move(link)) {}
ModbusServer::ModbusServer(ModbusServer&&) noexcept = default;
ModbusServer& ModbusServer::operator=(ModbusServer&&) noexcept = default;
ModbusServer::~ModbusServer() = default;

LinkAddress ModbusServer::address() const { return link_->address(); }
std::vector<pollfd> ModbusServer::poll_fds() const { return link_->poll_fds(); }
std::optional<ModbusServer::Clock::time_point> ModbusServer::next_deadline() const { return link_->next_deadline(); }
LinkFaults& ModbusServer::faults() { return link_->faults; }

std::size_t ModbusServer::serve_ready(RegisterHandler& handler, std::chrono::milliseconds timeout) {
  std::chrono::nanoseconds wait = timeout;
  if (const auto deadline = link_->next_deadline())
    wait = std::clamp<std::chrono::nanoseconds>(*deadline - Clock::now(), std::chrono::nanoseconds(0), wait);
  auto fds = link_->poll_fds();
  const timespec limit = timespec_of(wait);
  (void)::ppoll(fds.data(), fds.size(), &limit, nullptr);
  return link_->step(handler, fds);
}

}  // namespace ecs::protocol
