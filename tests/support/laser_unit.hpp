// A mill's unit behind a pseudo-terminal at the speed of a slow line, and a map for it ready to be sent from the
// screen.
#pragma once

#include <csignal>
#include <sstream>

#include <spawn.h>
#include <sys/wait.h>

#include "app/cli/program.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "tests/support/laser_screen.hpp"

namespace ecs::app {

inline const std::string kEmulator = std::string(ECS_BUILD_FOLDER) + "/ecs_emulator/ecs-emulator";

inline bool built() {
  if (std::filesystem::exists(kEmulator)) return true;
  MESSAGE("skipped: " << kEmulator << " is not built");
  return false;
}

/// A mill's unit behind a pseudo-terminal at the speed of a slow line; its memory outlives it.
class PacedUnit {
 public:
  PacedUnit(const LaserFolder& folder, std::string baud) : folder_(&folder), baud_(std::move(baud)) { start(); }
  PacedUnit(const PacedUnit&) = delete;
  PacedUnit& operator=(const PacedUnit&) = delete;
  ~PacedUnit() { kill(); }

  void start() {
    const std::string pty = (folder_->path / "unit").string();
    std::error_code error;
    std::filesystem::remove(pty, error);
    std::vector<std::string> words{kEmulator, "serve",     "--machine", "samples/mill/machine.toml",
                                   "--pty",   pty,         "--memory",  (folder_->path / "battery.bin").string(),
                                   "--mode",  "integrate", "--pace",    baud_};
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", 1, 0600);
    ::posix_spawn(&child_, kEmulator.c_str(), &files, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    for (int k = 0; k < 1200 && !std::filesystem::exists(pty, error); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  void kill() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = -1;
  }
  [[nodiscard]] std::string link() const { return "rtu:" + (folder_->path / "unit").string() + ":" + baud_; }

 private:
  const LaserFolder* folder_;
  std::string baud_;
  pid_t child_ = -1;
};

/// Linear scope: three lines are enough for a map.
struct LinearMill {
  explicit LinearMill(const LaserFolder& folder, double step_mm = 50.0)
      : files{folder.with("EXX.csv", measured_csv({'X', "EX", 0, -4100, step_mm, {0, -1400, 0}}, error)),
              folder.with("EYY.csv", measured_csv({'Y', "EY", -1400, 0, step_mm}, error)),
              folder.with("EZZ.csv", measured_csv({'Z', "EZ", 0, -1000, step_mm, {0, -1400, 0}}, error))} {}
  static double error(double p) { return 20.0 * std::sin(p / 400.0); }
  std::vector<std::string> files;
};

inline void make_ready(LaserSitting& sitting, const LaserFolder& folder, const LinearMill& mill) {
  sitting.controller().change("all", [&](LaserChoices& c) {
    for (const std::string& file : mill.files) c.files.push_back({file, {}});
    c.params_file = "samples/mill/parameters.toml";
    c.scope = "linear";
    c.map_file = (folder.path / "map.csv").string();
  });
  REQUIRE(sitting.settled());
  REQUIRE(sitting.controller().work().map.complete());
  sitting.type("8");
}

inline std::string ran_text(const std::vector<std::string>& words) {
  std::ostringstream out, messages;
  const int code = run_program(words, out, messages);
  return fmt::format("{} {}{}", code, out.str(), messages.str());
}

/// Saved and sent by keys.
inline void send_from(LaserSitting& sitting) {
  sitting.type("\n");
  REQUIRE(sitting.shows("Send the map to"));
  sitting.type("y");
  REQUIRE(sitting.until([&] { return sitting.controller().sent_is_current(); }, 60));
}

}  // namespace ecs::app
