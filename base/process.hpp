// What a program has to do with others: signals as a flag that long work looks at, so that nothing is left half done;
// another program run to its end; a descriptor that closes itself. Does not live here: programs that stay
// (commissioning/link/emulator_process.hpp).
#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <unistd.h>

#include "base/result.hpp"

namespace ecs {

struct ChildWords {
  std::string_view name;          ///< in problems
  std::string_view when_missing;  ///< what to do then
  double limit_s = 60.0;          ///< then it is killed, as when a signal comes
};

/// What the program says on stdout. An `output` problem where it is not found, does not end in time, says nothing or
/// fails: then with what it said on stderr.
/// @param words  the program, by its path or from PATH, and its arguments  @param input  its stdin
[[nodiscard]] Result<std::string> output_of(std::vector<std::string> words, std::string_view input,
                                            const ChildWords& child);

/// From now on these signals set the flag in place of ending the program. SIGPIPE and SIGXFSZ are ignored, so that a
/// closed pipe or a file that may not grow is a write error like any other.
void catch_signals();

/// Set once a signal came, or while a stop is asked for; hand it to links as LinkOptions::cancelled.
[[nodiscard]] const std::atomic<bool>& interrupted();

/// Whoever runs a verb beside a screen asks it to stop in good order, as Ctrl-C does in a shell.
void ask_to_stop();
/// The verb has stopped: the next one may run. A signal that came meanwhile stays.
void stop_asking();

/// The number of the first signal; 0: none.
[[nodiscard]] int interrupting_signal();

class Descriptor {
 public:
  explicit Descriptor(int opened = -1) : fd_(opened) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    Descriptor before(std::exchange(fd_, std::exchange(other.fd_, -1)));
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

}  // namespace ecs
