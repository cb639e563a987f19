#include "commissioning/link/port_survey.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "protocol/line/modbus_link.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A built-in port without a chip has the driver serial8250's "type" 0.
bool has_hardware(const std::string& name) {
  std::error_code error;
  const fs::path entry = fs::path("/sys/class/tty") / name;
  if (!fs::exists(entry / "device", error)) return false;
  std::array<char, 8> type{};
  const Descriptor file(::open((entry / "type").c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return true;
  return ::read(file.get(), type.data(), type.size() - 1) <= 0 || type[0] != '0';
}

/// Joining a group helps only if that group may read and write, and nobody should join root.
std::string way_to_permission(const std::string& device) {
  struct stat file {};
  const group* owner = ::stat(device.c_str(), &file) == 0 ? ::getgrgid(file.st_gid) : nullptr;
  const bool group_may = (file.st_mode & (S_IRGRP | S_IWGRP)) == (S_IRGRP | S_IWGRP);
  if (owner != nullptr && file.st_gid != 0 && group_may)
    return fmt::format("run `sudo usermod -aG {} $USER`, then log out and in again", owner->gr_name);
  return fmt::format(
      "no group may use this port: as root write `KERNEL==\"{}\", GROUP=\"dialout\", MODE=\"0660\"` into "
      "/etc/udev/rules.d/90-ecs.rules, run `udevadm control --reload` and `udevadm trigger`, and join the group with "
      "`usermod -aG dialout` and your name",
      fs::path(device).filename().string());
}

speed_t speed_of(int baud) {
  constexpr std::array<std::pair<int, speed_t>, 8> kSpeeds{{{1200, B1200},
                                                            {2400, B2400},
                                                            {4800, B4800},
                                                            {9600, B9600},
                                                            {19200, B19200},
                                                            {38400, B38400},
                                                            {57600, B57600},
                                                            {115200, B115200}}};
  for (const auto& [number, speed] : kSpeeds)
    if (number == baud) return speed;
  return B115200;
}

void make_raw(int fd, const protocol::SerialPort& line) {
  termios mode{};
  if (::tcgetattr(fd, &mode) != 0) return;
  ::cfmakeraw(&mode);
  mode.c_cflag |= CLOCAL | CREAD;
  if (line.parity != 'N') mode.c_cflag |= PARENB;
  if (line.parity == 'O') mode.c_cflag |= PARODD;
  if (line.stop_bits == 2) mode.c_cflag |= CSTOPB;
  ::cfsetspeed(&mode, speed_of(line.baud));
  ::tcsetattr(fd, TCSANOW, &mode);
  ::tcflush(fd, TCIOFLUSH);
}

/// Function 3 on the identity block.
std::vector<std::uint8_t> read_request(int unit) {
  constexpr auto first = protocol::kIdentity.first;
  std::vector<std::uint8_t> frame{static_cast<std::uint8_t>(unit), 3, first >> 8, first & 0xFF, 0, 2};
  const std::uint16_t crc = protocol::crc16_of(frame);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

}  // namespace

std::vector<std::string> serial_ports() {
  std::vector<std::string> ports;
  for (const std::string& name : names_in("/dev")) {
    const bool adapter = name.starts_with("ttyUSB") || name.starts_with("ttyACM") || name.starts_with("rfcomm");
    const bool built_in = (name.starts_with("ttyS") || name.starts_with("ttyAMA")) && has_hardware(name);
    if (adapter || built_in) ports.push_back("/dev/" + name);
  }
  for (const std::string& name : names_in("/dev/serial/by-id")) ports.push_back("/dev/serial/by-id/" + name);
  return ports;
}

std::optional<PortTrouble> trouble_with(const std::string& device) {
  const auto lock = protocol::lock_port(device);
  if (lock) return std::nullopt;
  PortTrouble trouble{lock.error().problem.message, {}};
  const auto ports = serial_ports();
  switch (lock.error().failure) {
    case protocol::LinkFailure::no_such_port:
      trouble.action =
          ports.empty() ? std::string("this computer has no serial port now: plug the adapter in and look at `dmesg`")
                        : fmt::format("ports there are: {}", fmt::join(ports, ", "));
      break;
    case protocol::LinkFailure::no_permission:
      trouble.action = way_to_permission(device);
      break;
    case protocol::LinkFailure::not_a_serial_port:
      trouble.action = ports.empty() ? std::string("give the name of a serial port, such as /dev/ttyUSB0")
                                     : fmt::format("serial ports are: {}", fmt::join(ports, ", "));
      break;
    case protocol::LinkFailure::port_in_use:
      trouble.action = "one program at a time can use a port";
      break;
    default:
      trouble.action = "look at `dmesg` for what the system says about this port";
  }
  return trouble;
}

bool PortAnswer::is_echo() const {
  return received.size() >= sent.size() && std::equal(sent.begin(), sent.end(), received.begin());
}

Result<PortAnswer> raw_answer(const protocol::SerialPort& line, int unit) {
  const Descriptor port(::open(line.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (port.get() < 0) return problem(ProblemKind::link, fmt::format("{}: {}", line.device, std::strerror(errno)));
  make_raw(port.get(), line);
  PortAnswer answer{read_request(unit), {}};
  if (::write(port.get(), answer.sent.data(), answer.sent.size()) != static_cast<ssize_t>(answer.sent.size()))
    return problem(ProblemKind::link, fmt::format("{}: cannot write: {}", line.device, std::strerror(errno)));
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  while (std::chrono::steady_clock::now() < end && answer.received.size() < 256) {
    pollfd readable{port.get(), POLLIN, 0};
    if (::poll(&readable, 1, 50) <= 0) continue;
    std::array<std::uint8_t, 256> piece{};
    const ssize_t length = ::read(port.get(), piece.data(), piece.size());
    if (length <= 0) break;
    answer.received.insert(answer.received.end(), piece.begin(), piece.begin() + length);
  }
  return answer;
}

}  // namespace ecs::commissioning
