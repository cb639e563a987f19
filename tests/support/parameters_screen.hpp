// What the tests of the parameters screen share: a folder with files and a state of its own, keys in, pictures out.
#pragma once

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include "app/screens/parameters/screen.hpp"
#include "app/ui/screen_program.hpp"
#include "base/file.hpp"

namespace ecs::app::parameters_case {

class ParametersCase {
 public:
  ParametersCase() {
    std::string name = (std::filesystem::temp_directory_path() / "ecs-parameters-XXXXXX").string();
    folder = ::mkdtemp(name.data());
    ::setenv("ECS_STATE_DIR", (folder / "state").c_str(), 1);
    ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
    REQUIRE(write_file(folder / "p.toml",
                       "[identity]\nmachine = \"moving column mill\"\n[compensation]\nscope = \"linear\"\n"
                       "[axis.X]\ndeadband_um = 4.0\n[axis.Y.datum]\napproach_direction = \"reverse\"\n"));
  }
  ParametersCase(const ParametersCase&) = delete;
  ParametersCase& operator=(const ParametersCase&) = delete;
  ~ParametersCase() {
    ::unsetenv("ECS_STATE_DIR");
    ::unsetenv("XDG_CONFIG_HOME");
    std::error_code fault;
    std::filesystem::remove_all(folder, fault);
  }
  [[nodiscard]] std::string file(const std::string& name = "p.toml") const { return (folder / name).string(); }

  std::filesystem::path folder;
};

/// A controller whose line cannot be opened.
inline std::shared_ptr<UnitConnection> no_line() {
  return std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600");
}

inline std::string seen(const Screen& screen, int rows = 24, int columns = 80, Glyphs glyphs = Glyphs::unicode) {
  return picture_of(screen, screen.title(), {}, Canvas(rows, columns, glyphs), false).plain_text();
}
/// Blanks and ends of lines between words count as one blank: a sentence may be wrapped.
inline std::string flat(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '\n')
      out += c;
    else if (!out.empty() && out.back() != ' ')
      out += ' ';
  return out;
}
inline bool has(const std::string& text, const std::string& part) {
  return flat(text).find(flat(part)) != std::string::npos;
}
inline void press(Screen& screen, Key::Name name) { (void)screen.on_key({name}); }
inline void type(Screen& screen, const std::string& text) {
  for (const char c : text) (void)screen.on_key({Key::Name::letter, static_cast<char32_t>(c)});
}
inline void enter(Screen& screen, const std::string& text) {
  type(screen, text);
  press(screen, Key::Name::enter);
}
inline void clear_line(Screen& screen) { (void)screen.on_key({Key::Name::control, U'u'}); }
/// The cursor on the field that has that in its key.
inline void find(Screen& screen, const std::string& part) { enter(screen, "/" + part); }
/// Edits the field under the cursor.
inline void edit(Screen& screen, const std::string& value) {
  press(screen, Key::Name::enter);
  clear_line(screen);
  enter(screen, value);
}

/// Until the picture shows it; half a minute at most.
inline bool shows(Screen& screen, const std::string& text) {
  for (int k = 0; k < 3000; ++k) {
    (void)screen.advance();
    if (has(seen(screen), text)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  MESSAGE(seen(screen));
  return false;
}

/// With the file of the case open.
inline void open_file(Screen& screen, const ParametersCase& one) {
  type(screen, "o");
  clear_line(screen);
  enter(screen, one.file());
}

}  // namespace ecs::app::parameters_case
