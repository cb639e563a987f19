// RTU on the master side of a pseudo-terminal: the client opens the slave side like a serial port.
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include "protocol/line/frame_cut.hpp"
#include "protocol/registers/frame_check.hpp"
#include "protocol/server/server_link.hpp"

namespace ecs::protocol {

namespace {

using namespace std::chrono_literals;

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
          ? fmt::format("{}: this link leads to {}; remove it, or name another link", link.string(), target.string())
          : fmt::format("{}: this link leads to {}, which {} has open; end that, or name another link", link.string(),
                        target.string(), user));
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
  std::size_t step(RegisterHandler& handler) override {
    listen();
    std::size_t answered = 0;
    while (cut_request() && Clock::now() >= request_due_) {
      carry_out(request_, handler, connection_, channel_, request_due_, pace_);
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
  }

  /// True when `request_` holds a whole request. What was heard and is no request is dropped after a silence.
  bool cut_request() {
    if (!request_.empty()) return true;
    if (heard_.empty()) return false;
    const auto length = rtu_request_length(heard_);
    if (length && heard_.size() >= *length && crc_agrees(std::span(heard_).first(*length))) return take(*length);
    if (Clock::now() - last_heard_ < kFrameSilence) return false;
    if (crc_agrees(heard_)) return take(heard_.size());
    heard_.clear();
    return false;
  }
  bool take(std::size_t length) {
    const auto end = heard_.begin() + static_cast<std::ptrdiff_t>(length);
    request_.assign(heard_.begin(), end);
    heard_.erase(heard_.begin(), end);
    request_due_ = first_heard_ + pace_.byte_time * length;
    first_heard_ = request_due_;
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
  PtyOptions options_;
  Descriptor master_;
  Descriptor keeper_;  ///< a slave side of our own: without it the master reads errors while no client has it open
  std::string slave_;
  bool link_made_ = false;
  std::uint64_t connection_ = next_connection();
  WirePace pace_;
  std::vector<std::uint8_t> heard_;
  Clock::time_point first_heard_{};
  Clock::time_point last_heard_{};
  std::vector<std::uint8_t> request_;  ///< cut, not yet carried out
  Clock::time_point request_due_{};    ///< when its last byte has passed the wire
  ReplyChannel channel_;
};

tl::unexpected<Problem> pty_problem() {
  return problem(ProblemKind::output, fmt::format("cannot make a pseudo-terminal: {}", std::strerror(errno)));
}

}  // namespace

Result<std::unique_ptr<ServerLink>> open_pty_link(const PtyOptions& options) {
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
  return link;
}

}  // namespace ecs::protocol
