// What every screen is: state in, picture out; key in, step out. The loop, the header and the status line are not its
// business (screen_program.hpp), nor is any terminal (terminal.hpp).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/keys.hpp"

namespace ecs::app {

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

}  // namespace ecs::app
