// A bench with fake USB devices and a person at it: starts a program under the bench, follows what it says, and does
// what a script (stdin) tells. Run under umockdev-wrapper:
//   umockdev-wrapper fake_usb -- ecs laser capture … < script
//
//   plug NAME pedal|gauge|temper-old|temper-new [SERIAL]     unplug NAME
//   until TEXT              until the program has said it, after what was waited for last
//   press NAME              bounce NAME       double NAME (twice, 0.1 s apart)
//   show NAME UM            a gauge's value
//   degrees NAME AIR TABLE  what a stick answers from now on
//   measure NAME N MS       N times: until the program says "next: " (after 5 s: a press again), MS milliseconds, a
//   press wait MS                 start (the program, when its devices are there)         kill SIGNAL
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <thread>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/fake_devices/fake_hid.hpp"

namespace {

using ecs::fake::Bytes;

constexpr double kPatience_s = 30.0;
constexpr double kAgain_s = 5.0;

void rest(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

std::vector<Bytes> temper_answer(bool old, double air, double table) {
  const auto bytes = [](Bytes head, double value, double scale) {
    const auto raw = static_cast<unsigned>(static_cast<int>(std::lround(value * scale)));
    head.push_back(static_cast<std::uint8_t>(raw >> 8U));
    head.push_back(static_cast<std::uint8_t>(raw));
    return head;
  };
  const auto filled = [](Bytes report, std::uint8_t high, std::uint8_t low) {
    report.push_back(high);
    report.push_back(low);
    report.resize(8, 0);
    return report;
  };
  if (old) {
    Bytes one = bytes(bytes({0x80, 0x04}, air, 256.0), table, 256.0);
    one.resize(8, 0);
    return {one};
  }
  return {filled(bytes({0x80, 0x80}, air, 100.0), 0x4E, 0x20), filled(bytes({0x80, 0x01}, table, 100.0), 0x4E, 0x20)};
}

class Bench {
 public:
  explicit Bench(char** program) : program_(program) {}

  void start() {
    int pipe[2];
    if (::pipe(pipe) != 0) throw std::runtime_error("no pipe");
    child_ = ::fork();
    if (child_ == 0) {
      ::dup2(pipe[1], STDERR_FILENO);
      ::close(pipe[0]);
      ::close(pipe[1]);
      if (std::freopen("/dev/null", "r", stdin) == nullptr) std::_Exit(126);
      ::execvp(program_[0], program_);
      std::perror(program_[0]);
      std::_Exit(127);
    }
    ::close(pipe[1]);
    messages_ = pipe[0];
  }

  void until(const std::string& text) {
    if (!heard(text, kPatience_s)) throw std::runtime_error("never said: " + text);
  }

  bool heard(const std::string& text, double patience_s) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
    while (true) {
      const std::size_t at = said_.find(text, heard_);
      if (at != std::string::npos) {
        heard_ = at + text.size();
        return true;
      }
      if (std::chrono::steady_clock::now() > end) return false;
      if (!listen(50)) throw std::runtime_error("ended before it said: " + text);
    }
  }

  /// Takes what the program says; false: it has closed its mouth.
  bool listen(int ms) {
    pollfd wanted{messages_, POLLIN, 0};
    if (::poll(&wanted, 1, ms) <= 0) return true;
    char piece[4096];
    const ssize_t count = ::read(messages_, piece, sizeof piece);
    if (count <= 0) return false;
    said_.append(piece, static_cast<std::size_t>(count));
    std::cerr.write(piece, count);
    return true;
  }

  int ended() {
    while (listen(1000)) continue;
    int status = 0;
    ::waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  void obey(const std::string& line) {
    std::istringstream in(line);
    std::string verb, name;
    in >> verb;
    if (verb.empty() || verb[0] == '#') return;
    if (verb == "start") return start();
    if (verb == "until") {
      std::getline(in >> std::ws, name);
      return until(name);
    }
    if (verb == "wait") {
      int ms = 0;
      in >> ms;
      return rest(ms);
    }
    if (verb == "kill") {
      int signal = 0;
      in >> signal;
      ::kill(child_, signal);
      return;
    }
    in >> name;
    if (verb == "plug") return plug(name, in);
    ecs::fake::Device& device = *devices_.at(name);
    if (verb == "unplug") return device.unplug();
    if (verb == "press") return ecs::fake::press(device);
    if (verb == "bounce") return ecs::fake::press_bouncing(device, 3);
    if (verb == "measure") return measure(device, in);
    double first = 0.0, second = 0.0;
    in >> first >> second;
    if (verb == "show") return ecs::fake::show(device, first);
    if (verb == "degrees") return ecs::fake::answer_like_temper(device, temper_answer(old_[name], first, second));
    if (verb != "double") throw std::runtime_error("what is " + line);
    ecs::fake::press(device);
    rest(60);
    ecs::fake::press(device);
  }

 private:
  void plug(const std::string& name, std::istream& in) {
    std::string kind, serial;
    in >> kind >> serial;
    ecs::fake::DeviceSpec spec = kind == "pedal"        ? ecs::fake::pedal_spec(serial)
                                 : kind == "gauge"      ? ecs::fake::gauge_spec()
                                 : kind == "temper-old" ? ecs::fake::temper_spec(0x0C45, 0x7401)
                                                        : ecs::fake::temper_spec(0x413D, 0x2107);
    old_[name] = kind == "temper-old";
    devices_[name] = bus_.plug(spec);
  }

  void measure(ecs::fake::Device& device, std::istream& in) {
    int times = 0, pause_ms = 0;
    in >> times >> pause_ms;
    for (int k = 0; k < times; ++k) {
      // On a machine so busy that press and release arrive together a press may be lost: a person presses again.
      while (!heard("next: ", kAgain_s)) {
        std::cerr << "fake_usb: pressed again\n";
        ecs::fake::press(device, 35);
      }
      rest(pause_ms);
      ecs::fake::press(device, 35);
    }
  }

  char** program_;
  ecs::fake::Bus bus_;
  std::map<std::string, std::unique_ptr<ecs::fake::Device>> devices_;
  std::map<std::string, bool> old_;
  pid_t child_ = -1;
  int messages_ = -1;
  std::string said_;
  std::size_t heard_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || std::string(argv[1]) != "--") {
    std::cerr << "usage: fake_usb -- PROGRAM ARGUMENTS < script\n";
    return 2;
  }
  try {
    Bench bench(argv + 2);
    for (std::string line; std::getline(std::cin, line);) bench.obey(line);
    return bench.ended();
  } catch (const std::exception& error) {
    std::cerr << "fake_usb: " << error.what() << '\n';
    return 99;
  }
}
