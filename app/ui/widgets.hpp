// Parts of screens: a list to choose from, a line to type into, text to scroll; messages, questions with yes or no, the
// progress of long work. They hold a place, not the content.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// Where one stands in a list; the part seen follows.
struct ListPlace {
  int selected = 0;
  mutable int first = 0;  ///< row of the list in the upper row of its area; set while drawing
  mutable Area seen{};    ///< rows that were drawn

  /// The row of the list that a click hit.
  [[nodiscard]] std::optional<int> clicked(const Key& key) const;
  /// Up, down, page, home, end, mouse wheel. @return whether the key was one of them
  [[nodiscard]] bool on_key(const Key& key, int count, int page = 10);
};

struct ListRow {
  std::string text;
  Tone tone = Tone::plain;
};
/// Rows with the selected one marked (reverse, and `>` for terminals that show no tones); a scroll mark at the right.
void draw_list(Canvas& canvas, const Area& area, const std::vector<ListRow>& rows, const ListPlace& place,
               bool active = true);

/// Marks at the right edge of a list or text of `count` rows that is seen from `first` on: there is more above, below.
void draw_scroll_marks(Canvas& canvas, const Area& area, int first, int count);

/// "[1 Setting]  2 Doctor  3 Statistics": the pages of a screen with the one shown in brackets.
void draw_tabs(Canvas& canvas, const Area& area, int row, std::span<const char* const> titles, int here);

/// Text that is longer, or wider, than its area.
struct ScrollPlace {
  static constexpr int kColumns = 8;  ///< that a key moves sideways
  mutable int first = 0;
  mutable int column = 0;  ///< of the lines at the left edge
  /// Up, down, page, home (the first row from its beginning), end, mouse wheel; left and right sideways.
  [[nodiscard]] bool on_key(const Key& key, int page = 10);
};
/// The answer of a verb for a narrow place: sentences over as many lines as they need, indented as they were; rows of
/// tables, whose cells stand two blanks or more apart, stay whole.
[[nodiscard]] std::vector<std::string> sentences_wrapped(const std::vector<std::string>& lines, int columns);
/// All rows move sideways together: columns of a table stay below their headings. Marks where rows go on.
void draw_scrolled(Canvas& canvas, const Area& area, const std::vector<std::string>& lines, const ScrollPlace& place);

/// One line of text being typed.
class TextLine {
 public:
  TextLine() = default;
  explicit TextLine(const std::string& text) : text_(code_points(text)), at_(text_.size()) {}
  [[nodiscard]] bool on_key(const Key& key);
  [[nodiscard]] std::string text() const;
  void set(const std::string& text);
  /// A text that the first letter typed replaces; every other key keeps it.
  void propose(const std::string& text);
  /// Nobody has typed it: it is empty, or still as it was proposed.
  [[nodiscard]] bool is_untouched() const { return text_.empty() || proposed_; }
  void draw(Canvas& canvas, const Area& area, int row, int column, int columns, bool active) const;
  /// Column of the cursor within `columns`.
  [[nodiscard]] int cursor_column(int columns) const;

 private:
  [[nodiscard]] std::size_t first_seen(int columns) const;
  [[nodiscard]] int columns_before_cursor(std::size_t first) const;
  std::u32string text_;
  std::size_t at_ = 0;
  bool proposed_ = false;
};

/// The rest of a path as far as the folder decides it; what is there to choose from if it does not.
struct PathCompletion {
  std::string completed;
  std::vector<std::string> choices;
};
[[nodiscard]] PathCompletion completed_path(const std::string& typed);
/// The same for the last of several paths, separated by blanks; one with blanks in it is put in quotes.
[[nodiscard]] PathCompletion completed_paths(const std::string& typed);

/// Rows that a message takes, 1 to `most`: a screen gives it those and the rest to what stands above.
[[nodiscard]] int rows_of_message(const Message& message, int columns, int most);
/// Whole words over as many rows as `area` has; the last one ends in "… F2" where it is not all (cells.hpp).
void draw_message(Canvas& canvas, const Area& area, const Message& message);

enum class Reply { none, yes, no };
/// y: yes; n, Esc: no; Enter is neither: nobody confirms by accident.
[[nodiscard]] Reply reply_to(const Key& key);
/// A box in the middle of `area`.
void draw_question(Canvas& canvas, const Area& area, const Question& question);
/// Nothing where none waits.
void draw_question(Canvas& canvas, const Area& area, const Asking& asking);
/// @return whether the key was for the question: while one waits, all are
bool answers(Asking& asking, const Key& key);

/// A bar of `value` on a scale that ends at `most`; the scale is as long as the area.
void draw_bar(Canvas& canvas, const Area& area, int row, double value, double most, Tone tone);

/// "sending the map  [=======>      ]  62 %  8 s left"; a negative `seconds_left` is not shown.
void draw_progress(Canvas& canvas, const Area& area, int row, const std::string& label, double part,
                   double seconds_left = -1.0);

}  // namespace ecs::app
