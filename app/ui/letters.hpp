// Letters as a terminal shows them: UTF-8, the columns that a letter takes, words in lines, the nearest character of
// ASCII.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

}  // namespace ecs::app
