#include "app/ui/cells.hpp"

#include <algorithm>

namespace ecs::app {
namespace {

struct Frame {
  char32_t horizontal, vertical, top_left, top_right, bottom_left, bottom_right;
};
constexpr Frame kLines{U'─', U'│', U'┌', U'┐', U'└', U'┘'};
constexpr Frame kAsciiFrame{U'-', U'|', U'+', U'+', U'+', U'+'};

}  // namespace

Area Area::inside(int by) const {
  return {row + by, column + by, std::max(0, rows - 2 * by), std::max(0, columns - 2 * by)};
}
Area Area::top(int rows_wanted) const { return {row, column, std::clamp(rows_wanted, 0, rows), columns}; }
Area Area::below(int rows_skipped) const {
  const int skipped = std::clamp(rows_skipped, 0, rows);
  return {row + skipped, column, rows - skipped, columns};
}
Area Area::left(int columns_wanted) const { return {row, column, rows, std::clamp(columns_wanted, 0, columns)}; }
Area Area::right_of(int columns_skipped) const {
  const int skipped = std::clamp(columns_skipped, 0, columns);
  return {row, column + skipped, rows, columns - skipped};
}

Canvas::Canvas(int rows, int columns, Glyphs glyphs, bool slow)
    : rows_(std::max(0, rows)),
      columns_(std::max(0, columns)),
      glyphs_(glyphs),
      slow_(slow),
      cells_(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_)) {}

const Cell& Canvas::at(int row, int column) const {
  static const Cell kNone;
  if (row < 0 || column < 0 || row >= rows_ || column >= columns_) return kNone;
  return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)];
}

void Canvas::put(int row, int column, char32_t glyph, Tone tone) {
  if (row < 0 || column < 0 || row >= rows_ || column >= columns_) return;
  const bool ascii = glyphs_ == Glyphs::ascii;
  const char32_t shown = glyph < 0x20 ? U' ' : (ascii ? in_ascii(glyph) : glyph);
  if (columns_of(glyph) < 2) return set(row, column, {shown, tone});
  if (column + 1 == columns_) return set(row, column, {U' ', tone});  // half of it would be outside
  set(row, column, {shown, tone});
  set(row, column + 1, {ascii ? shown : U' ', tone});
  if (!ascii) cell(row, column + 1).glyph = kSecondHalf;
}

/// A letter of two columns of which one is overwritten leaves a blank in the other.
void Canvas::set(int row, int column, Cell content) {
  if (column > 0 && cell(row, column).glyph == kSecondHalf) cell(row, column - 1).glyph = U' ';
  if (column + 1 < columns_ && cell(row, column + 1).glyph == kSecondHalf) cell(row, column + 1).glyph = U' ';
  cell(row, column) = content;
}

int Canvas::text(const Area& area, int row, int column, std::string_view utf8, Tone tone) {
  if (row < 0 || row >= area.rows || column >= area.columns) return 0;
  const std::vector<Letter> letters = letters_of(utf8);
  const int room = area.columns - column;
  int wanted = 0;
  for (const Letter& letter : letters) wanted += letter.columns;
  const bool cut = wanted > room;
  int used = 0;
  for (const Letter& letter : letters) {
    if (used + letter.columns > (cut ? room - 1 : room)) break;
    put(area.row + row, area.column + column + used, letter.glyph, tone);
    used += letter.columns;
  }
  if (cut) put(area.row + row, area.column + column + used, U'…', tone);
  if (cut && used + 1 < room) put(area.row + row, area.column + column + used + 1, U' ', tone);
  return std::min(wanted, room);
}

void Canvas::text_right(const Area& area, int row, std::string_view utf8, Tone tone) {
  text(area, row, std::max(0, area.columns - width_of(utf8)), utf8, tone);
}

int Canvas::paragraph(const Area& area, int first_row, std::string_view utf8, Tone tone) {
  const auto lines = wrapped(utf8, area.columns);
  const int count = static_cast<int>(lines.size());
  const int room = area.rows - first_row;
  for (int k = 0; k < std::min(count, room); ++k)
    text(area, first_row + k, 0, lines[static_cast<std::size_t>(k)], tone);
  if (count > room) keep_whole(utf8);
  if (count > room && room > 0) draw_more_mark(area, lines[static_cast<std::size_t>(room - 1)], tone);
  return count;
}

/// The last row of a text that goes on: its last words make room for the mark.
void Canvas::draw_more_mark(const Area& area, std::string_view line, Tone tone) {
  const std::string mark = glyphs_ == Glyphs::ascii ? "... F2" : "… F2";
  const int row = area.rows - 1;
  if (area.columns < width_of(mark) + 4) return;
  fill({area.row + row, area.column, 1, area.columns});
  text(area, row, 0, wrapped(line, area.columns - width_of(mark) - 1).front(), tone);
  text_right(area, row, mark, Tone::strong);
}

void Canvas::keep_whole(std::string_view text) {
  if (std::find(whole_texts_.begin(), whole_texts_.end(), text) == whole_texts_.end()) whole_texts_.emplace_back(text);
}

void Canvas::fill(const Area& area, char32_t glyph, Tone tone) {
  for (int r = 0; r < area.rows; ++r)
    for (int c = 0; c < area.columns; ++c) put(area.row + r, area.column + c, glyph, tone);
}

void Canvas::paint(const Area& area, Tone tone) {
  for (int r = 0; r < area.rows; ++r)
    for (int c = 0; c < area.columns; ++c)
      if (const int row = area.row + r, column = area.column + c;
          row >= 0 && column >= 0 && row < rows_ && column < columns_)
        cell(row, column).tone = tone;
}

void Canvas::frame(const Area& area, std::string_view title, Tone tone) {
  if (area.rows < 2 || area.columns < 2) return;
  const Frame& f = glyphs_ == Glyphs::ascii ? kAsciiFrame : kLines;
  const int bottom = area.row + area.rows - 1;
  const int right = area.column + area.columns - 1;
  for (int c = area.column + 1; c < right; ++c) {
    put(area.row, c, f.horizontal, tone);
    put(bottom, c, f.horizontal, tone);
  }
  for (int r = area.row + 1; r < bottom; ++r) {
    put(r, area.column, f.vertical, tone);
    put(r, right, f.vertical, tone);
  }
  put(area.row, area.column, f.top_left, tone);
  put(area.row, right, f.top_right, tone);
  put(bottom, area.column, f.bottom_left, tone);
  put(bottom, right, f.bottom_right, tone);
  if (!title.empty())
    text({area.row, area.column, 1, area.columns - 1}, 0, 2, " " + std::string(title) + " ", Tone::strong);
}

std::string Canvas::plain_text() const {
  std::string out;
  for (int r = 0; r < rows_; ++r) {
    std::string line;
    for (int c = 0; c < columns_; ++c)
      if (at(r, c).glyph != kSecondHalf) line += utf8_of(at(r, c).glyph);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

}  // namespace ecs::app
