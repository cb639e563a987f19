#include "app/ui/cells.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include <utf8proc.h>

namespace ecs::app {
namespace {

/// Length of the sequence that this byte begins; 0: it begins none.
std::size_t sequence_length(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// Takes no column because it stands over, or formats, the letters around it; others that take none cannot be printed.
bool is_mark(char32_t glyph) {
  const auto category = utf8proc_category(static_cast<utf8proc_int32_t>(glyph));
  return category == UTF8PROC_CATEGORY_MN || category == UTF8PROC_CATEGORY_ME || category == UTF8PROC_CATEGORY_MC ||
         category == UTF8PROC_CATEGORY_CF || category == UTF8PROC_CATEGORY_LO;
}

/// Columns in which it is seen: what cannot be printed takes one, as '?'.
int seen_columns(char32_t glyph) {
  const int columns = columns_of(glyph);
  return columns > 0 || is_mark(glyph) ? columns : 1;
}

/// Letters with their marks as one character each, as far as there are such.
std::u32string composed(const std::u32string& points) {
  const std::string text = utf8_of(points);
  utf8proc_uint8_t* joined = nullptr;
  const auto length =
      utf8proc_map(reinterpret_cast<const utf8proc_uint8_t*>(text.data()), static_cast<utf8proc_ssize_t>(text.size()),
                   &joined, static_cast<utf8proc_option_t>(UTF8PROC_COMPOSE | UTF8PROC_STABLE));
  const std::unique_ptr<utf8proc_uint8_t, void (*)(void*)> owned(joined, std::free);
  if (length < 0) return points;
  return code_points({reinterpret_cast<const char*>(joined), static_cast<std::size_t>(length)});
}

}  // namespace

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

std::string utf8_of(std::u32string_view glyphs) {
  std::string out;
  for (const char32_t glyph : glyphs) out += utf8_of(glyph);
  return out;
}

int columns_of(char32_t glyph) {
  if (glyph < 0x7F) return 1;
  return std::clamp(utf8proc_charwidth(static_cast<utf8proc_int32_t>(glyph)), 0, 2);
}

std::vector<Letter> letters_of(std::string_view utf8) {
  std::vector<Letter> letters;
  letters.reserve(utf8.size());
  const auto add = [&letters](char32_t glyph, int columns) {
    letters.push_back({glyph < 0x20 ? U' ' : glyph, columns});
  };
  if (is_ascii(utf8)) {
    for (const char c : utf8) add(c == 0x7F ? U'?' : static_cast<char32_t>(c), 1);
    return letters;
  }
  std::u32string points = code_points(utf8);
  if (std::any_of(points.begin(), points.end(), [](char32_t glyph) { return columns_of(glyph) == 0; }))
    points = composed(points);
  for (const char32_t glyph : points) {
    const int columns = columns_of(glyph);
    if (columns > 0)
      add(glyph, columns);
    else if (seen_columns(glyph) > 0)
      add(U'?', 1);
  }
  return letters;
}

int width_of(std::string_view utf8) {
  if (is_ascii(utf8)) return static_cast<int>(utf8.size());
  int columns = 0;
  for (const Letter& letter : letters_of(utf8)) columns += letter.columns;
  return columns;
}

std::string in_columns(std::string_view utf8, int columns) {
  const std::vector<Letter> letters = letters_of(utf8);
  int wanted = 0;
  for (const Letter& letter : letters) wanted += letter.columns;
  const int room = std::max(0, columns) - (wanted > columns ? 1 : 0);
  std::string out;
  int used = 0;
  for (const Letter& letter : letters) {
    if (used + letter.columns > room) break;
    out += utf8_of(letter.glyph);
    used += letter.columns;
  }
  if (wanted > columns && columns > 0) {
    out += "…";
    ++used;
  }
  return out + std::string(static_cast<std::size_t>(std::max(0, columns - used)), ' ');
}

namespace {

/// The beginning of a word that fits into `columns`, at least one letter, cut off from it.
std::string cut_off(std::string& word, int columns) {
  const std::u32string points = code_points(word);
  std::size_t count = 0;
  for (int used = 0; count < points.size(); ++count) {
    used += seen_columns(points[count]);
    if (used > columns && count > 0) break;
  }
  const std::u32string_view all(points);
  word = utf8_of(all.substr(count));
  return utf8_of(all.substr(0, count));
}

}  // namespace

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
    while (width_of(word) > most && code_points(word).size() > 1) {  // a word longer than the line is broken
      line = cut_off(word, most);
      end_line();
    }
    if (!word.empty()) line += (line.empty() ? "" : " ") + word;
    if (stop < utf8.size() && utf8[stop] == '\n') end_line();
    at = stop + 1;
  }
  if (!line.empty() || lines.empty()) end_line();
  return lines;
}

namespace {

/// The letter of ASCII below the accents; '?' where there is none.
char32_t without_accent(char32_t glyph) {
  std::array<utf8proc_int32_t, 8> parts{};
  int boundary = 0;
  const auto count =
      utf8proc_decompose_char(static_cast<utf8proc_int32_t>(glyph), parts.data(),
                              static_cast<utf8proc_ssize_t>(parts.size()), UTF8PROC_DECOMPOSE, &boundary);
  return count > 0 && parts[0] < 0x80 ? static_cast<char32_t>(parts[0]) : U'?';
}

}  // namespace

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
      return without_accent(glyph);
  }
}

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
