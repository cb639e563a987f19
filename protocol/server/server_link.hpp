// The two kinds of link a server sits on; what they share is one step of the event loop.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "protocol/line/frame_codec.hpp"
#include "protocol/line/reply_channel.hpp"
#include "protocol/server/server.hpp"

namespace ecs::protocol {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] explicit operator bool() const { return fd_ >= 0; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_ = -1;
};

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
  /// Reads what is there, answers what is complete and due, writes what is due. @return requests answered
  virtual std::size_t step(RegisterHandler& handler) = 0;

  LinkFaults faults;
  std::optional<Clock::time_point> last_request;

 protected:
  ServerLink(FrameCodec codec, Framing framing) : codec_(std::move(codec)), framing_(framing) {}
  /// Carries out one request and puts its reply, spoilt or not, into the channel. The reply begins one gap after
  /// `request_end`, when the request's last byte had passed the wire, or now if that is over.
  /// @param connection  that it came on, from next_connection()
  void carry_out(std::span<const std::uint8_t> frame, RegisterHandler& handler, std::uint64_t connection,
                 ReplyChannel& channel, Clock::time_point request_end, const WirePace& pace);
  /// A number that no other connection of this program has, on whichever link.
  [[nodiscard]] static std::uint64_t next_connection();

 private:
  FrameCodec codec_;
  Framing framing_;
};

[[nodiscard]] Result<std::unique_ptr<ServerLink>> open_pty_link(const PtyOptions& options);
[[nodiscard]] Result<std::unique_ptr<ServerLink>> open_tcp_link(const TcpOptions& options);

}  // namespace ecs::protocol
