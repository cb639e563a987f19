// A serial port for one program at a time: an advisory lock on the device.
#pragma once

#include <string>
#include <utility>

#include "base/result.hpp"
#include "protocol/line/link_failure.hpp"

namespace ecs::protocol {

/// Why a port cannot be opened, and the message.
struct PortProblem {
  LinkFailure failure = LinkFailure::none;
  Problem problem;
};

/// Opens the device beside the library's own handle, checks that it is a serial port and locks it. Destroying it
/// unlocks.
class PortLock {
 public:
  [[nodiscard]] static tl::expected<PortLock, PortProblem> take(const std::string& device);
  PortLock(PortLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  PortLock& operator=(PortLock&&) = delete;
  ~PortLock();

 private:
  explicit PortLock(int fd) : fd_(fd) {}
  int fd_ = -1;
};

/// A port that cannot be used, as the answer of the function that opened it.
[[nodiscard]] tl::unexpected<PortProblem> failed(LinkFailure failure, std::string message);

}  // namespace ecs::protocol
