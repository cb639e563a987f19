// A picture of the terminal as cells, drawn into without any terminal, so that every screen can be tested as text.
// Does not live here: the terminal itself (terminal.hpp), what is drawn (the screens).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ecs::app {

/// What a cell means; the terminal turns it into colours where it has them, else into bold, reverse, underline.
enum class Tone : std::uint8_t {
  plain,
  faint,     ///< frames, units, hints
  strong,    ///< headings, the thing that matters
  selected,  ///< under the cursor
  good,
  warning,
  bad,
  forward,  ///< approach +1
  reverse,  ///< approach −1
};

struct Cell {
  char32_t glyph = U' ';
  Tone tone = Tone::plain;
  friend bool operator==(const Cell&, const Cell&) = default;
};

struct Place {
  int row = 0;
  int column = 0;
};

/// A rectangle of cells, in rows and columns from its parent's upper left corner.
struct Area {
  int row = 0;
  int column = 0;
  int rows = 0;
  int columns = 0;
  /// So many cells less on each side; never negative.
  [[nodiscard]] Area inside(int by = 1) const;
  [[nodiscard]] Area top(int rows_wanted) const;
  [[nodiscard]] Area below(int rows_skipped) const;
  [[nodiscard]] Area left(int columns_wanted) const;
  [[nodiscard]] Area right_of(int columns_skipped) const;
};

/// Which signs the terminal can show.
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
  /// Nothing happens outside.
  void put(int row, int column, char32_t glyph, Tone tone = Tone::plain);
  /// UTF-8, on one row, cut at the right edge of `area` with an ellipsis; @return columns used
  int text(const Area& area, int row, int column, std::string_view utf8, Tone tone = Tone::plain);
  /// At the right edge.
  void text_right(const Area& area, int row, std::string_view utf8, Tone tone = Tone::plain);
  /// Words over several rows, from `first_row`; @return rows used
  int paragraph(const Area& area, int first_row, std::string_view utf8, Tone tone = Tone::plain);
  void fill(const Area& area, char32_t glyph = U' ', Tone tone = Tone::plain);
  /// Changes the tone of what is there.
  void paint(const Area& area, Tone tone);
  /// A frame on the edge of `area`, its title in the upper edge.
  void frame(const Area& area, std::string_view title = {}, Tone tone = Tone::faint);

  /// Rows of text without trailing blanks; for tests, copies and pictures.
  [[nodiscard]] std::string plain_text() const;

 private:
  int rows_;
  int columns_;
  Glyphs glyphs_;
  bool slow_;
  std::vector<Cell> cells_;
};

/// UTF-8 to code points; what is no UTF-8 becomes '?'.
[[nodiscard]] std::u32string code_points(std::string_view utf8);
[[nodiscard]] std::string utf8_of(char32_t glyph);
/// Columns that a text takes on a terminal.
[[nodiscard]] int width_of(std::string_view utf8);
/// Words of a text in lines of at most `columns`.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view utf8, int columns);
/// The nearest sign of ASCII: µ → u, ± → +/- is left to the caller (one cell is one sign).
[[nodiscard]] char32_t in_ascii(char32_t glyph);

}  // namespace ecs::app
