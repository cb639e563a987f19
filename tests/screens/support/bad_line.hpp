// Lines that go wrong: an emulator of one's own at the end of a bridge that echoes, or is deaf at the wrong speed.
#pragma once

#include <array>
#include <chrono>
#include <thread>

#include <poll.h>
#include <termios.h>

#include "tests/screens/support/unit_screen.hpp"

namespace ecs::app::screen_test {

/// `ecs-emulator serve` with these options besides machine and line.
class OwnEmulator {
 public:
  OwnEmulator(const StateFolder& one, std::vector<std::string> options) : pty((one.path / "line").string()) {
    std::vector<std::string> words{kEmulator,    "serve", "--machine",  "samples/mill/machine.toml",
                                   "--pty",      pty,     "--workshop", workshop(one),
                                   "--arm-code", kArmCode};
    words.insert(words.end(), options.begin(), options.end());
    child_ = started(words);
    for (int k = 0; k < 3000 && !std::filesystem::exists(workshop(one)); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  OwnEmulator(const OwnEmulator&) = delete;
  OwnEmulator& operator=(const OwnEmulator&) = delete;
  ~OwnEmulator() { end_process(child_, SIGTERM); }
  [[nodiscard]] static std::string workshop(const StateFolder& one) { return (one.path / "shop").string(); }
  /// A line fault, as `ecs-emulator workshop … fault` takes it.
  static void fault(const StateFolder& one, const std::string& words) {
    const std::string command = kEmulator + " workshop " + workshop(one) + " fault " + words;
    REQUIRE(std::system((command + " > /dev/null").c_str()) == 0);
  }
  std::string pty;

 private:
  pid_t child_ = -1;
};

/// A pseudo-terminal that gives back what is sent, or leads on to another one where the speed is right.
class BadLine {
 public:
  /// @param to  leads there; empty: gives back what is sent
  explicit BadLine(std::string to, speed_t speed = B9600) : to_(std::move(to)), speed_(speed) {
    near_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    REQUIRE(::grantpt(near_) == 0);
    REQUIRE(::unlockpt(near_) == 0);
    device = ::ptsname(near_);
    keep_ = ::open(device.c_str(), O_RDWR | O_NOCTTY);  // so that the near end does not hang up
    make_raw(keep_);
    if (!to_.empty()) {
      for (int k = 0; k < 3000 && far_ < 0; ++k) {  // what it leads to may still be starting
        far_ = ::open(to_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
        if (far_ < 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      REQUIRE(far_ >= 0);
      make_raw(far_);
    }
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) carry();
    });
  }
  BadLine(const BadLine&) = delete;
  BadLine& operator=(const BadLine&) = delete;
  ~BadLine() {
    thread_.request_stop();
    thread_.join();
    for (const int fd : {near_, keep_, far_})
      if (fd >= 0) ::close(fd);
  }
  std::string device;

 private:
  static void make_raw(int fd) {
    termios mode{};
    ::tcgetattr(fd, &mode);
    ::cfmakeraw(&mode);
    ::tcsetattr(fd, TCSANOW, &mode);
  }
  void carry() {
    std::array<pollfd, 2> ends{{{near_, POLLIN, 0}, {far_, POLLIN, 0}}};
    if (::poll(ends.data(), far_ >= 0 ? 2 : 1, 10) <= 0) return;
    std::array<char, 512> bytes{};
    if ((ends[0].revents & POLLIN) != 0) {
      const ssize_t length = ::read(near_, bytes.data(), bytes.size());
      if (length > 0) put(far_ < 0 ? near_ : (speed_is_right() ? far_ : -1), bytes.data(), length);
    }
    if (far_ >= 0 && (ends[1].revents & POLLIN) != 0) {
      const ssize_t length = ::read(far_, bytes.data(), bytes.size());
      if (length > 0) put(near_, bytes.data(), length);
    }
  }
  [[nodiscard]] bool speed_is_right() const {
    termios mode{};
    return ::tcgetattr(keep_, &mode) == 0 && ::cfgetospeed(&mode) == speed_ && (mode.c_cflag & PARENB) == 0;
  }
  static void put(int fd, const char* bytes, ssize_t length) {
    if (fd >= 0) static_cast<void>(!::write(fd, bytes, static_cast<std::size_t>(length)));
  }

  std::string to_;
  speed_t speed_;
  int near_ = -1;
  int keep_ = -1;
  int far_ = -1;
  std::jthread thread_;
};

}  // namespace ecs::app::screen_test
