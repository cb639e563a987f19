#include "app/ui/copying.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/ui/letters.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

std::string row_text(const Canvas& canvas, const Area& area, int row) {
  std::u32string letters;
  for (int column = area.column; column < area.column + area.columns; ++column)
    if (const char32_t glyph = canvas.at(row, column).glyph; glyph != kSecondHalf) letters += glyph;
  return std::string(trimmed(utf8_of(letters)));
}

bool is_selected(const Canvas& canvas, const Area& area, int row) {
  for (int column = area.column; column < area.column + area.columns; ++column)
    if (const Cell& cell = canvas.at(row, column); cell.tone == Tone::selected && cell.glyph != U' ') return true;
  return false;
}

}  // namespace

std::string text_to_copy(const Canvas& canvas, const Area& area) {
  std::string selected, all;
  for (int row = area.row; row < area.row + area.rows; ++row) {
    const std::string line = row_text(canvas, area, row);
    if (!all.empty() || !line.empty()) all += line + "\n";
    if (is_selected(canvas, area, row)) selected += (selected.empty() ? "" : "\n") + line;
  }
  while (all.ends_with("\n")) all.pop_back();
  return selected.empty() ? all : selected;
}

std::string copied_words(const std::string& text) {
  const auto rows = std::count(text.begin(), text.end(), '\n') + 1;
  return rows > 1 ? fmt::format("copied: {} rows of this screen", rows) : "copied: " + text;
}

std::string idle_key_words(const Screen& screen, char32_t letter) {
  const std::string key = utf8_of(std::u32string(1, letter));
  for (const KeyHelp& help : screen.keys())
    for (const std::string_view name : split(help.keys, ' '))
      if (name == key) return fmt::format("{} ({}): there is nothing for it to do now", key, help.does);
  return fmt::format("{} does nothing here; {} lists the keys", key, screen.typing() ? "F1" : "?");
}

}  // namespace ecs::app
