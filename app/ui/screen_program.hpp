// The loop of the screens: draws the one in front with header and status line, hands it keys, keeps the way back. Over
// it the help with the words of the trade that are seen, and whole texts; what F4 copies.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "app/ui/terminal.hpp"
#include "app/ui/widgets.hpp"

namespace ecs::app {

/// A word of the trade, or of this unit, that a screen uses: `?` lists those that the picture shows.
struct ExplainedWord {
  std::string word;
  std::string meaning;
};

/// All of them, in the order of the alphabet; docs/glossary.md has the same.
[[nodiscard]] std::vector<ExplainedWord> explained_words();

/// Those that occur in a text, whatever their case, in the order of the alphabet.
[[nodiscard]] std::vector<ExplainedWord> words_explained_in(const std::string& text);

/// What is laid over any screen: its help (?), and whole what the screen shows in part only (F2). It scrolls.
class Overlay {
 public:
  [[nodiscard]] bool shown() const { return !title_.empty(); }
  /// @param seen  the picture of the screen: words of the trade that it shows are explained
  void show_help(const Screen& screen, const std::string& seen = {});
  /// Nothing is laid over where there is no text. What the log does not hold yet goes there as well.
  void show_whole(const std::vector<std::string>& texts);
  void draw(Canvas& canvas) const;
  /// Scrolls; any other key takes it away.
  void on_key(const Key& key);

 private:
  /// A text in lines; those after the first begin below it, behind the key.
  struct Part {
    std::string key;
    std::string text;
  };
  [[nodiscard]] std::vector<std::string> lines(int columns) const;
  /// Each in a row, or, where they are many, those of one purpose together.
  void add_keys(const std::vector<KeyHelp>& keys);

  std::string title_;  ///< empty: nothing is laid over
  std::vector<Part> parts_;
  ScrollPlace scroll_;
  mutable int page_ = 1;  ///< rows seen
  mutable bool fits_ = true;
  mutable bool end_ = true;  ///< the last row is seen
};

/// The rows that are selected, else the whole picture without header and key line. @param area  of the screen itself
[[nodiscard]] std::string text_to_copy(const Canvas& canvas, const Area& area);

/// "copied: EXX  X axis …"; of several rows how many.
[[nodiscard]] std::string copied_words(const std::string& text);

/// Why a letter that changed nothing did nothing, in one line.
[[nodiscard]] std::string idle_key_words(const Screen& screen, char32_t letter);

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
