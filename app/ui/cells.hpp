// A picture of a screen without a terminal: cells with a letter and a tone each, and how many columns a letter takes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "app/names/commissioning.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// A letter in the columns it takes: 1, or 2 as those of Chinese and most pictures do.
struct Letter {
  char32_t glyph = U' ';
  int columns = 1;
  friend bool operator==(const Letter&, const Letter&) = default;
};

/// The letters of a text, in order. A mark that stands over another letter is joined with it where Unicode has one
/// character for both, else left away; control characters become a blank or '?'.
[[nodiscard]] std::vector<Letter> letters_of(std::string_view utf8);

/// Columns of one letter on a terminal, 0 to 2, by its East Asian width (Unicode Standard Annex 11).
[[nodiscard]] int columns_of(char32_t glyph);

/// UTF-8 to code points; what is no UTF-8 becomes '?'.
[[nodiscard]] std::u32string code_points(std::string_view utf8);
[[nodiscard]] std::string utf8_of(char32_t glyph);
[[nodiscard]] std::string utf8_of(std::u32string_view glyphs);
/// Columns that a text takes on a terminal.
[[nodiscard]] int width_of(std::string_view utf8);
/// The text with blanks behind it, so that it takes `columns`; cut with an ellipsis where it is longer.
[[nodiscard]] std::string in_columns(std::string_view utf8, int columns);
/// Words of a text in lines of at most `columns`.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view utf8, int columns);
/// The nearest character of ASCII: µ → u, ± → +/- is left to the caller (one cell is one character).
[[nodiscard]] char32_t in_ascii(char32_t glyph);

/// In the cell behind a letter that takes two columns.
inline constexpr char32_t kSecondHalf = 0;

struct Cell {
  char32_t glyph = U' ';
  Tone tone = Tone::plain;
  friend bool operator==(const Cell&, const Cell&) = default;
};

struct CellPosition {
  int row = 0;
  int column = 0;
};

/// A rectangle of cells, in rows and columns from its parent's upper left corner.
struct Area {
  int row = 0;
  int column = 0;
  int rows = 0;
  int columns = 0;
  /// This many cells less on each side; never negative.
  [[nodiscard]] Area inside(int by = 1) const;
  /// One column less at the left and at the right.
  [[nodiscard]] Area between_margins() const { return {row, column + 1, rows, columns - 2}; }
  [[nodiscard]] Area top(int rows_wanted) const;
  [[nodiscard]] Area below(int rows_skipped) const;
  [[nodiscard]] Area left(int columns_wanted) const;
  [[nodiscard]] Area right_of(int columns_skipped) const;
};

/// Which glyphs the terminal can show.
enum class Glyphs : std::uint8_t { ascii, unicode };

class Canvas {
 public:
  /// @param slow  the terminal hangs on a slow line: what changes all the time should change seldom
  Canvas(int rows, int columns, Glyphs glyphs = Glyphs::unicode, bool slow = false);

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] Glyphs glyphs() const { return glyphs_; }
  [[nodiscard]] bool slow() const { return slow_; }
  [[nodiscard]] Area whole() const { return {0, 0, rows_, columns_}; }

  /// A space where there is no such cell.
  [[nodiscard]] const Cell& at(int row, int column) const;
  /// Nothing happens outside. A letter of two columns takes the next cell as well.
  void put(int row, int column, char32_t glyph, Tone tone = Tone::plain);
  /// UTF-8, on one row, cut at the right edge of `area` with an ellipsis; @return columns used
  int text(const Area& area, int row, int column, std::string_view utf8, Tone tone = Tone::plain);
  /// At the right edge.
  void text_right(const Area& area, int row, std::string_view utf8, Tone tone = Tone::plain);
  /// Words over several rows, from `first_row`. Where `area` ends too early the last row ends in "… F2" and the whole
  /// text is kept. @return rows wanted
  int paragraph(const Area& area, int first_row, std::string_view utf8, Tone tone = Tone::plain);
  void fill(const Area& area, char32_t glyph = U' ', Tone tone = Tone::plain);
  /// Changes the tone of what is there.
  void paint(const Area& area, Tone tone);
  /// A frame on the edge of `area`, its title in the upper edge.
  void frame(const Area& area, std::string_view title = {}, Tone tone = Tone::faint);

  /// Of texts that are seen in part only: F2 shows them whole, on every screen (screen_program.hpp).
  void keep_whole(std::string_view text);
  [[nodiscard]] const std::vector<std::string>& whole_texts() const { return whole_texts_; }

  /// Rows of text without trailing blanks; for tests, copies and pictures.
  [[nodiscard]] std::string plain_text() const;

 private:
  void set(int row, int column, Cell content);
  void draw_more_mark(const Area& area, std::string_view line, Tone tone);
  [[nodiscard]] Cell& cell(int row, int column) {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }

  int rows_;
  int columns_;
  Glyphs glyphs_;
  bool slow_;
  std::vector<Cell> cells_;
  std::vector<std::string> whole_texts_;
};

}  // namespace ecs::app
