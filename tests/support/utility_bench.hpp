// A unit for screens to work on: the bundled emulator with an empty battery, behind the one controller that screens
// share.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include <doctest/doctest.h>
#include <unistd.h>

#include "app/ui/screen.hpp"
#include "app/ui/screen_program.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app::utility_bench {

inline std::string emulator_built() {
  const std::string program = std::string(ECS_BUILD_FOLDER) + "/ecs_emulator/ecs-emulator";
  if (std::filesystem::exists(program)) return program;
  MESSAGE("skipped: " << program << " is not built");
  return {};
}

/// ECS_SHOW_PICTURES in the environment: every picture that is asked about goes to stdout.
inline std::string picture(const Screen& screen, Canvas canvas = Canvas(24, 80)) {
  const std::string text = picture_of(screen, screen.title(), {}, std::move(canvas), false).plain_text();
  if (std::getenv("ECS_SHOW_PICTURES") != nullptr) std::puts(text.c_str());
  return text;
}
inline Step press(Screen& screen, Key::Name name) { return screen.on_key({name}); }
inline Step letter(Screen& screen, char c) { return screen.on_key({Key::Name::letter, static_cast<char32_t>(c)}); }
inline void type(Screen& screen, const std::string& text) {
  for (const char c : text) (void)letter(screen, c);
}

/// Lets the screen go on until its picture has `part`; half a minute at most.
inline bool comes(Screen& screen, const std::string& part) {
  for (int k = 0; k < 3000; ++k) {
    (void)screen.advance();
    if (contains(picture_of(screen, "", {}, Canvas(24, 80), false).plain_text(), part)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  (void)picture(screen);
  return false;
}

/// A folder of its own for state, configuration and files.
class BenchFolder {
 public:
  BenchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "ecs-bench-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
    ::setenv("ECS_STATE_DIR", (path_ / "state").c_str(), 1);
    ::setenv("XDG_CONFIG_HOME", (path_ / "config").c_str(), 1);
  }
  BenchFolder(const BenchFolder&) = delete;
  BenchFolder& operator=(const BenchFolder&) = delete;
  ~BenchFolder() {
    for (const char* name : {"ECS_STATE_DIR", "XDG_CONFIG_HOME"}) ::unsetenv(name);
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

class Bench {
 public:
  Bench() { ::setenv("ECS_EMULATOR", (std::string(ECS_BUILD_FOLDER) + "/ecs_emulator/ecs-emulator").c_str(), 1); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;
  ~Bench() {
    controller.reset();
    ::unsetenv("ECS_EMULATOR");
  }

  BenchFolder folder;
  std::shared_ptr<UnitConnection> controller = std::make_shared<UnitConnection>("emulator");

  /// Until the unit answered for the first time.
  void wait_for_unit() const {
    for (int k = 0; k < 3000 && !controller->newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(controller->newest());
  }
  /// Until the unit's own clock shows that time: a restart is seen by it.
  void wait_until_it_ran(std::chrono::microseconds time) const {
    const auto ran = [&] {
      const auto newest = controller->newest();
      return newest && newest->unit_time_us >= static_cast<std::uint64_t>(time.count());
    };
    for (int k = 0; k < 3000 && !ran(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(ran());
  }
  /// Does work on the line as a screen would, without a screen.
  template <class Work>
  auto on_line(Work work) const {
    JobControl control;
    return controller->on_line(control, work);
  }
  /// kill -9 of the emulator, which is a child of this process.
  static void kill_emulator() {
    int killed = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string pid = entry.path().filename().string();
      if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
      std::ifstream file(entry.path() / "stat");
      std::string stat((std::istreambuf_iterator<char>(file)), {});
      const std::size_t open = stat.find('('), close = stat.rfind(')');
      if (open == std::string::npos || close == std::string::npos) continue;
      std::istringstream rest(stat.substr(close + 1));
      std::string state;
      int parent = 0;
      rest >> state >> parent;
      if (parent != ::getpid() || state == "Z" || !stat.substr(open + 1, close - open - 1).starts_with("ecs-emulator"))
        continue;
      ::kill(std::stoi(pid), SIGKILL);
      ++killed;
    }
    CHECK(killed == 1);
  }
};

}  // namespace ecs::app::utility_bench
