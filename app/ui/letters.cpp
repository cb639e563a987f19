#include "app/ui/letters.hpp"

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

}  // namespace ecs::app
