// Screens in tests: keys in, pictures out, no terminal.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "app/ui/screen_program.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "tests/support/test.hpp"

namespace ecs::app::screen_test {

inline std::string picture(const Screen& screen, int rows = 24, int columns = 80, Glyphs glyphs = Glyphs::unicode) {
  return picture_of(screen, screen.title(), {}, Canvas(rows, columns, glyphs), false).plain_text();
}

inline Step press(Screen& screen, Key::Name name) { return screen.on_key({name}); }
inline Step letter(Screen& screen, char c) { return screen.on_key({Key::Name::letter, static_cast<char32_t>(c)}); }
inline void type(Screen& screen, const std::string& text) {
  for (const char c : text) (void)letter(screen, c);
}
inline void enter(Screen& screen, const std::string& text) {
  type(screen, text);
  (void)press(screen, Key::Name::enter);
}
inline void clear_line(Screen& screen) { (void)screen.on_key({Key::Name::control, U'u'}); }
/// Another text in a text line, then Enter.
inline void replace_line(Screen& screen, const std::string& text) {
  clear_line(screen);
  enter(screen, text);
}

/// Blanks and line ends between words count as one blank: a sentence may be wrapped.
inline bool reads(const std::string& text, const std::string& part) {
  const auto flat = [](const std::string& wrapped) {
    std::string out;
    for (const char c : wrapped)
      if (c != ' ' && c != '\n')
        out += c;
      else if (!out.empty() && out.back() != ' ')
        out += ' ';
    return out;
  };
  return contains(flat(text), flat(part));
}

/// Draws and advances until the condition holds; half a minute at most.
inline bool until(Screen& screen, const std::function<bool()>& holds) {
  for (int k = 0; k < 3000; ++k) {
    (void)screen.advance();
    (void)picture(screen);
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  MESSAGE(picture(screen));
  return false;
}
inline bool shows(Screen& screen, const std::string& part, int rows = 24, int columns = 80) {
  return until(screen, [&] { return reads(picture(screen, rows, columns), part); });
}

/// A connection whose link cannot be opened.
inline std::shared_ptr<UnitConnection> no_link() {
  return std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600");
}

}  // namespace ecs::app::screen_test
