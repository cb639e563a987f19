// Parts of screens: a list to choose from, a line to type into, text to scroll. They hold a place, not the content.
// Does not live here: screens (screen.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/screens/cells.hpp"
#include "app/screens/keys.hpp"

namespace ecs::app {

/// Where one stands in a list; the part seen follows.
struct ListPlace {
  int selected = 0;
  mutable int first = 0;  ///< row of the list in the upper row of its area; set while drawing

  /// Up, down, page, home, end. @return whether the key was one of them
  [[nodiscard]] bool on_key(const Key& key, int count, int page = 10);
};

struct ListRow {
  std::string text;
  Tone tone = Tone::plain;
};
/// Rows with the selected one marked (reverse, and `>` for terminals that show no tones); a scroll mark at the right.
void draw_list(Canvas& canvas, const Area& area, const std::vector<ListRow>& rows, const ListPlace& place,
               bool active = true);

/// Text that is longer than its area.
struct ScrollPlace {
  mutable int first = 0;
  /// Up, down, page, home, end.
  [[nodiscard]] bool on_key(const Key& key, int page = 10);
};
void draw_scrolled(Canvas& canvas, const Area& area, const std::vector<std::string>& lines, const ScrollPlace& place);

/// One line of text being typed.
class TextLine {
 public:
  TextLine() = default;
  explicit TextLine(const std::string& text) : text_(code_points(text)), at_(text_.size()) {}
  [[nodiscard]] bool on_key(const Key& key);
  [[nodiscard]] std::string text() const;
  void set(const std::string& text);
  void draw(Canvas& canvas, const Area& area, int row, int column, int columns, bool active) const;
  /// Column of the cursor within `columns`.
  [[nodiscard]] int cursor_column(int columns) const;

 private:
  [[nodiscard]] std::size_t first_seen(int columns) const;
  std::u32string text_;
  std::size_t at_ = 0;
};

/// The rest of a path as far as the folder decides it; what is there to choose from if it does not.
struct PathCompletion {
  std::string completed;
  std::vector<std::string> choices;
};
[[nodiscard]] PathCompletion completed_path(const std::string& typed);
/// The same for the last of several paths, separated by blanks; one with blanks in it is put in quotes.
[[nodiscard]] PathCompletion completed_paths(const std::string& typed);

}  // namespace ecs::app
