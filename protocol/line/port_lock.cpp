// Opening and locking a serial port, and why it cannot be had.
#include "protocol/line/port_lock.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

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

tl::expected<PortLock, PortProblem> PortLock::take(const std::string& device) {
  const int fd = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return open_failed(device, errno);
  PortLock lock(fd);
  if (::isatty(fd) == 0)
    return failed(LinkFailure::not_a_serial_port, fmt::format("{}: this is not a serial port", device));
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    const std::string holder = holder_of(fd);
    return failed(LinkFailure::port_in_use,
                  fmt::format("{}: in use by {}; end it first", device, holder.empty() ? "another program" : holder));
  }
  return lock;
}

PortLock::~PortLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace ecs::protocol
