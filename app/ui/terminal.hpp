// The terminal: shows a canvas, reads keys, gives the terminal back as it was however the program ends. ncurses stays
// in the implementation.
#pragma once

#include <memory>
#include <string_view>

#include "app/ui/cells.hpp"
#include "app/ui/screen.hpp"
#include "base/result.hpp"

namespace ecs::app {

struct TerminalOptions {
  bool ascii = false;  ///< no glyphs beyond ASCII, whatever the locale says
  bool colour = true;  ///< false with NO_COLOR
  bool mouse = true;
};

/// One at a time. Catches SIGINT, SIGTERM, SIGHUP and SIGTSTP by the handlers of base/process.hpp and its own; after
/// SIGSEGV and SIGABRT the terminal is put right before the program dies.
class Terminal {
 public:
  /// Refused where stdin or stdout is no terminal, or TERM is unknown or cannot place the cursor.
  [[nodiscard]] static Result<std::unique_ptr<Terminal>> open(const TerminalOptions& options);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// A blank canvas of the present size.
  [[nodiscard]] Canvas canvas() const;
  /// Sends the cells that changed; the cursor is shown at `cursor`, or not at all (row −1). On a slow line a picture
  /// goes in pieces, so that the next key need not wait: heading, message and key line first.
  /// @param urgent  a key changed it; else it may wait where the terminal is behind
  /// @return whether all of it is on its way: if not, show it again
  [[nodiscard]] bool show(const Canvas& canvas, CellPosition cursor, bool urgent);
  /// The next key; Name::none after `wait_ms` without one.
  [[nodiscard]] Key read(int wait_ms);
  /// Puts text on the clipboard of the computer at which the user sits (OSC 52, raw; tmux passes it on where its
  /// `set-clipboard` is on). False where the terminal does not know that: a vt100 would print it.
  [[nodiscard]] bool copy(std::string_view text);
  /// Everything again, as after something else has written on the terminal.
  void redraw();

 private:
  struct Screen;
  explicit Terminal(std::unique_ptr<Screen> screen);
  std::unique_ptr<Screen> screen_;
};

}  // namespace ecs::app
