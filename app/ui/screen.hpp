// What every screen is: state in, picture out; key in, step out. Keys, whatever terminal sent them; those of a screen
// as a table, and the key line at the bottom: what fits of them, and which of them was clicked. Does not live here: the
// loop, the header and the status line (screen_program.hpp), the terminal (terminal.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/ui/cells.hpp"

namespace ecs::app {

struct Key {
  enum class Name : std::uint8_t {
    none,    ///< nothing came in time
    letter,  ///< `letter` says which
    enter,
    escape,
    tab,
    back_tab,
    backspace,
    erase,  ///< Delete
    up,
    down,
    left,
    right,
    page_up,
    page_down,
    home,
    end,
    function,  ///< `number` says which: F1 … F12
    control,   ///< with the letter of `letter`: Ctrl-C is 'c'
    mouse,     ///< pressed at `row`, `column`
    wheel_up,  ///< turned there
    wheel_down,
    resized,  ///< the terminal has another size now
  };
  Name name = Name::none;
  char32_t letter = 0;
  int number = 0;
  int row = 0;
  int column = 0;
  friend bool operator==(const Key&, const Key&) = default;
};

[[nodiscard]] constexpr bool is_letter(const Key& key, char32_t letter) {
  return key.name == Key::Name::letter && key.letter == letter;
}

class Screen;

/// What a key leads to.
struct Step {
  enum class Kind {
    stay,
    back,     ///< to the screen before
    open,     ///< `next`, this one stays behind it
    instead,  ///< `next` takes the place of this one
    leave,    ///< the program
  };
  Kind kind = Kind::stay;
  std::unique_ptr<Screen> next;
};

/// A key as help and the bottom line name it: {"d", "diagnose"}.
struct KeyHelp {
  std::string keys;
  std::string does;
};

class Screen {
 public:
  virtual ~Screen() = default;
  [[nodiscard]] virtual std::string title() const = 0;
  virtual void draw(Canvas& canvas, const Area& area) const = 0;
  [[nodiscard]] virtual Step on_key(const Key& key) = 0;
  /// The most useful first: the bottom line shows as many as fit, `?` shows all.
  [[nodiscard]] virtual std::vector<KeyHelp> keys() const = 0;
  /// What this screen is for, for `?`.
  [[nodiscard]] virtual std::string help() const = 0;
  /// Several times a second. @return whether the picture changed
  [[nodiscard]] virtual bool advance() { return false; }
  /// A screen that is ready to be opened in front of this one, once; asked after advance().
  [[nodiscard]] virtual std::unique_ptr<Screen> opens_by_itself() { return nullptr; }
  /// Letters are text now, not commands: F1 helps, not ?.
  [[nodiscard]] virtual bool typing() const { return false; }
  /// Where the terminal's cursor belongs; row −1: nowhere.
  [[nodiscard]] virtual CellPosition cursor(const Area& /*area*/) const { return {-1, -1}; }
  /// What F4 copies; empty: the selected row, else the whole picture.
  [[nodiscard]] virtual std::string copied() const { return {}; }
  /// Work that would be lost by leaving; empty: none.
  [[nodiscard]] virtual std::string unsaved() const { return {}; }
};

[[nodiscard]] inline Step stay() { return {}; }
[[nodiscard]] inline Step back() { return {Step::Kind::back, nullptr}; }
[[nodiscard]] inline Step opened(std::unique_ptr<Screen> next) { return {Step::Kind::open, std::move(next)}; }
[[nodiscard]] inline Step replaced_by(std::unique_ptr<Screen> next) { return {Step::Kind::instead, std::move(next)}; }

struct KeyLine {
  std::vector<KeyHelp> keys;  ///< the most useful first
  std::vector<KeyHelp> ends;  ///< at the right edge, always: help, whole texts
};

void draw_key_line(Canvas& canvas, const Area& line, const KeyLine& keys);

/// The key that the line names at a column: of several, "up/down", "+ - 0", the one that was hit, the first if it was
/// what they do. Nothing where there is none, or none that a click can stand for ("1-5").
[[nodiscard]] std::optional<Key> clicked_key(const Area& line, const KeyLine& keys, int column);

/// "Enter", "PgUp", "F1", "Ctrl-U", "d"
[[nodiscard]] std::optional<Key> key_named(std::string_view name);

/// A key of a screen, said once: key line, help and handling follow from it.
struct KeyRow {
  std::string keys;              ///< "v", "up/down", "+ -": each does the same
  std::string does;              ///< empty: the key line does not name it
  std::function<void()> act{};   ///< empty: the screen takes the key on its own
  std::function<bool()> when{};  ///< empty: always
  bool always = false;           ///< it acts, though it is not named, when that does not hold
};
/// Those that are there now.
[[nodiscard]] std::vector<KeyHelp> helps_of(const std::vector<KeyRow>& rows);
/// Does what the first row with this key says. @return whether there was one
bool act_on(const std::vector<KeyRow>& rows, const Key& key);

}  // namespace ecs::app
