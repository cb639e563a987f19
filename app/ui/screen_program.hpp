// The loop of the screens: draws the one in front with header and status line, hands it keys, keeps the way back.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "app/ui/screen.hpp"
#include "app/ui/terminal.hpp"

namespace ecs::app {

/// Said in the status line of every screen.
struct StatusLine {
  std::string link;   ///< "EMULATOR", "rtu:/dev/ttyUSB0:115200"; empty: none open
  std::string state;  ///< mode and fault of the unit, if known
  bool bad = false;   ///< a fault, or no answer
  friend bool operator==(const StatusLine&, const StatusLine&) = default;
};
using StatusLineNow = std::function<StatusLine()>;

/// The picture of a screen at a size: header, screen, key line, its help over it. Pure; used by the loop, by tests and
/// by `docs` pictures.
[[nodiscard]] Canvas picture_of(const Screen& screen, const std::string& path, const StatusLine& status, Canvas canvas,
                                bool with_help);
/// Where the screen itself is drawn on a canvas of that size.
[[nodiscard]] Area screen_area(const Canvas& canvas);

/// A screen that is to be opened in front of whichever is there; null: none.
using ScreenInFront = std::function<std::unique_ptr<Screen>()>;

/// What the loop asks for beside the screens themselves.
struct ProgramHooks {
  StatusLineNow status_line;
  ScreenInFront in_front{};  ///< asked in every turn
  ScreenInFront finder{};    ///< asked on F3: any action by its name
  ScreenInFront commands{};  ///< asked on F6: what was done, as commands
};

/// Until the last screen is left or a signal comes. @return exit code
[[nodiscard]] int run_screens(Terminal& terminal, std::unique_ptr<Screen> first, const ProgramHooks& hooks);

}  // namespace ecs::app
