// Screens in tests: keys in, pictures out, no terminal.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
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
/// Letters are letters; \n Enter, \t Tab, \x1b Esc.
inline Key key_of(char c) {
  switch (c) {
    case '\n':
      return {Key::Name::enter};
    case '\t':
      return {Key::Name::tab};
    case '\x1b':
      return {Key::Name::escape};
    default:
      return {Key::Name::letter, static_cast<char32_t>(c)};
  }
}
inline void type(Screen& screen, const std::string& keys) {
  for (const char c : keys) (void)screen.on_key(key_of(c));
}
/// What is seen when these keys were typed.
inline std::string after(Screen& screen, const std::string& keys) {
  type(screen, keys);
  return picture(screen);
}
inline void enter(Screen& screen, const std::string& text) { type(screen, text + "\n"); }
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

inline void check_reads(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) CHECK_MESSAGE(reads(text, part), part, " in ", text);
}

/// The screen fits any size, in as many lines as there are; a terminal of ASCII gets nothing else.
inline void check_fits(const Screen& screen) {
  for (const auto& [rows, columns] : {std::pair{24, 80}, {40, 120}, {60, 200}, {12, 40}, {5, 20}, {3, 10}, {1, 1}})
    for (const Glyphs glyphs : {Glyphs::ascii, Glyphs::unicode}) {
      const std::string text = picture(screen, rows, columns, glyphs);
      CHECK_MESSAGE(count_of(text, '\n') == static_cast<std::size_t>(rows), screen.title());
      if (glyphs == Glyphs::unicode) continue;
      CHECK_MESSAGE(std::all_of(text.begin(), text.end(), [](char c) { return (c & 0x80) == 0; }), screen.title());
    }
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

/// The same when these keys were typed.
inline bool shows_after(Screen& screen, const std::string& keys, const std::string& part) {
  type(screen, keys);
  return shows(screen, part);
}

/// A connection whose link cannot be opened.
inline std::shared_ptr<UnitConnection> no_link() {
  return std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600");
}

}  // namespace ecs::app::screen_test
