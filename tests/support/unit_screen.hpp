// What tests of screens with a unit share: a folder of its own for state and stored link, keys, waiting for a picture,
// and the emulator to be killed.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <unistd.h>

#include "app/cli/program.hpp"
#include "app/ui/screen_program.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app::unit_case {

class UnitCase {
 public:
  UnitCase() {
    std::string name = (std::filesystem::temp_directory_path() / "ecs-unit-XXXXXX").string();
    folder = ::mkdtemp(name.data());
    ::setenv("ECS_STATE_DIR", (folder / "state").c_str(), 1);
    ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
  }
  UnitCase(const UnitCase&) = delete;
  UnitCase& operator=(const UnitCase&) = delete;
  ~UnitCase() {
    ::unsetenv("ECS_STATE_DIR");
    ::unsetenv("XDG_CONFIG_HOME");
    std::error_code error;
    std::filesystem::remove_all(folder, error);
  }
  [[nodiscard]] static bool has_emulator() {
    if (emulator_program()) return true;
    MESSAGE("skipped: ecs-emulator is not built");
    return false;
  }
  [[nodiscard]] std::string with(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
  std::filesystem::path folder;
};

inline std::string picture(const Screen& screen, int rows = 24, int columns = 80, Glyphs glyphs = Glyphs::unicode) {
  return picture_of(screen, screen.title(), {}, Canvas(rows, columns, glyphs), false).plain_text();
}
inline Step press(Screen& screen, Key::Name name) { return screen.on_key({name}); }
inline void type(Screen& screen, const std::string& text) {
  for (const char c : text) (void)screen.on_key({Key::Name::letter, static_cast<char32_t>(c)});
}
/// What stands in a text line goes, then the text and Enter.
inline void enter(Screen& screen, const std::string& text) {
  (void)screen.on_key({Key::Name::control, U'u'});
  type(screen, text);
  (void)press(screen, Key::Name::enter);
}

/// Draws and advances until the condition holds; half a minute at most.
inline bool until(Screen& screen, const std::function<bool()>& holds) {
  for (int k = 0; k < 1500; ++k) {
    (void)screen.advance();
    (void)picture(screen);
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  MESSAGE(picture(screen));
  return false;
}
inline bool shows(Screen& screen, const std::string& part) {
  return until(screen, [&] { return contains(picture(screen), part); });
}

/// `ecs` with these words, over the line of the controller.
inline int ran_on(UnitConnection& unit, const std::vector<std::string>& words) {
  const auto lent = unit.lend();
  std::ostringstream out, messages;
  const int code = run_program(words, out, messages);
  if (code != 0) MESSAGE(messages.str());
  return code;
}

/// Parameters with a map for the sample mill.
inline void give_map(UnitConnection& unit, const UnitCase& one) {
  const std::string params =
      one.with("p.toml", "[compensation]\nscope = \"linear\"\n[axis.Y.datum]\napproach_direction = \"reverse\"\n");
  const std::string map = one.with("map.csv",
                                   "axis,sense,approach,p_mm,value_um\nX,EX,0,-4100,1\nX,EX,0,0,5\nY,EY,0,-1400,1\n"
                                   "Y,EY,0,0,2\nZ,EZ,0,-1000,1\nZ,EZ,0,0,3\n");
  REQUIRE(ran_on(unit, {"map", "send", map, "--params", params}) == 0);
}

/// kill -9 for every emulator that this program started. @return how many
inline int kill_emulators() {
  int killed = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      std::string name;
      std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm"), name);
      if (name == "ecs-emulator" && ::kill(child, SIGKILL) == 0) ++killed;
    }
  }
  return killed;
}

}  // namespace ecs::app::unit_case
