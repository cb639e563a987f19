#include "app/screens/cells.hpp"

#include <algorithm>

namespace ecs::app {
namespace {

struct Frame {
  char32_t horizontal, vertical, top_left, top_right, bottom_left, bottom_right;
};
constexpr Frame kLines{U'─', U'│', U'┌', U'┐', U'└', U'┘'};
constexpr Frame kSigns{U'-', U'|', U'+', U'+', U'+', U'+'};

/// Length of the sequence that this byte begins; 0: it begins none.
std::size_t sequence_length(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

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

std::u32string code_points(std::string_view utf8) {
  std::u32string points;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i]);
    const std::size_t length = sequence_length(first);
    char32_t point = length <= 1 ? first : first & (0xFFu >> (length + 1));
    bool sound = length > 0 && i + length <= utf8.size();
    for (std::size_t k = 1; sound && k < length; ++k) {
      const auto next = static_cast<unsigned char>(utf8[i + k]);
      sound = (next & 0xC0u) == 0x80u;
      point = point << 6 | (next & 0x3Fu);
    }
    points += sound ? point : U'?';
    i += sound ? length : 1;
  }
  return points;
}

std::string utf8_of(char32_t glyph) {
  std::string out;
  const auto add = [&](char32_t byte) { out += static_cast<char>(byte); };
  if (glyph < 0x80) {
    add(glyph);
  } else if (glyph < 0x800) {
    add(0xC0 | glyph >> 6);
    add(0x80 | (glyph & 0x3F));
  } else if (glyph < 0x10000) {
    add(0xE0 | glyph >> 12);
    add(0x80 | (glyph >> 6 & 0x3F));
    add(0x80 | (glyph & 0x3F));
  } else {
    add(0xF0 | glyph >> 18);
    add(0x80 | (glyph >> 12 & 0x3F));
    add(0x80 | (glyph >> 6 & 0x3F));
    add(0x80 | (glyph & 0x3F));
  }
  return out;
}

int width_of(std::string_view utf8) { return static_cast<int>(code_points(utf8).size()); }

std::vector<std::string> wrapped(std::string_view utf8, int columns) {
  std::vector<std::string> lines;
  const int most = std::max(1, columns);
  std::string line;
  const auto end_line = [&] {
    lines.push_back(line);
    line.clear();
  };
  std::size_t at = 0;
  while (at <= utf8.size()) {
    const std::size_t stop = std::min(utf8.find_first_of(" \n", at), utf8.size());
    std::string word(utf8.substr(at, stop - at));
    const int wanted = width_of(line) + (line.empty() ? 0 : 1) + width_of(word);
    if (!line.empty() && wanted > most) end_line();
    while (width_of(word) > most) {  // a word longer than the line is broken
      std::u32string points = code_points(word);
      line.clear();
      for (int k = 0; k < most; ++k) line += utf8_of(points[static_cast<std::size_t>(k)]);
      end_line();
      word.clear();
      for (std::size_t k = static_cast<std::size_t>(most); k < points.size(); ++k) word += utf8_of(points[k]);
    }
    if (!word.empty()) line += (line.empty() ? "" : " ") + word;
    if (stop < utf8.size() && utf8[stop] == '\n') end_line();
    at = stop + 1;
  }
  if (!line.empty() || lines.empty()) end_line();
  return lines;
}

char32_t in_ascii(char32_t glyph) {
  if (glyph < 0x80) return glyph;
  switch (glyph) {
    case U'µ':
    case U'μ':
      return U'u';
    case U'±':
    case U'┼':
    case U'┌':
    case U'┐':
    case U'└':
    case U'┘':
    case U'├':
    case U'┤':
    case U'┬':
    case U'┴':
      return U'+';
    case U'─':
    case U'–':
    case U'−':
      return U'-';
    case U'│':
      return U'|';
    case U'…':
      return U'~';
    case U'°':
      return U'o';
    case U'▲':
    case U'△':
    case U'↑':
      return U'^';
    case U'▼':
    case U'▽':
    case U'↓':
      return U'v';
    case U'→':
    case U'▶':
      return U'>';
    case U'←':
    case U'◀':
      return U'<';
    case U'●':
    case U'█':
      return U'#';
    case U'○':
    case U'·':
      return U'.';
    case U'σ':
      return U's';
    default:
      return U'?';
  }
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
  const char32_t shown = glyphs_ == Glyphs::ascii ? in_ascii(glyph) : glyph;
  cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)] = {
      shown < 0x20 ? U' ' : shown, tone};
}

int Canvas::text(const Area& area, int row, int column, std::string_view utf8, Tone tone) {
  if (row < 0 || row >= area.rows || column >= area.columns) return 0;
  const std::u32string points = code_points(utf8);
  const int room = area.columns - column;
  const int length = static_cast<int>(points.size());
  const bool cut = length > room;
  for (int k = 0; k < std::min(length, room); ++k)
    put(area.row + row, area.column + column + k, cut && k == room - 1 ? U'…' : points[static_cast<std::size_t>(k)],
        tone);
  return std::min(length, room);
}

void Canvas::text_right(const Area& area, int row, std::string_view utf8, Tone tone) {
  text(area, row, std::max(0, area.columns - width_of(utf8)), utf8, tone);
}

int Canvas::paragraph(const Area& area, int first_row, std::string_view utf8, Tone tone) {
  const auto lines = wrapped(utf8, area.columns);
  for (std::size_t k = 0; k < lines.size(); ++k) text(area, first_row + static_cast<int>(k), 0, lines[k], tone);
  return static_cast<int>(lines.size());
}

void Canvas::fill(const Area& area, char32_t glyph, Tone tone) {
  for (int r = 0; r < area.rows; ++r)
    for (int c = 0; c < area.columns; ++c) put(area.row + r, area.column + c, glyph, tone);
}

void Canvas::paint(const Area& area, Tone tone) {
  for (int r = 0; r < area.rows; ++r)
    for (int c = 0; c < area.columns; ++c)
      put(area.row + r, area.column + c, at(area.row + r, area.column + c).glyph, tone);
}

void Canvas::frame(const Area& area, std::string_view title, Tone tone) {
  if (area.rows < 2 || area.columns < 2) return;
  const Frame& f = glyphs_ == Glyphs::ascii ? kSigns : kLines;
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
    for (int c = 0; c < columns_; ++c) line += utf8_of(at(r, c).glyph);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

}  // namespace ecs::app
