#include "base/paragraph.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace ecs {

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(std::string_view text, std::size_t width) {
  const std::size_t taken = columns_of(text);
  return std::string(text) + std::string(width > taken ? width - taken : 0, ' ');
}

std::string paragraph(std::string_view text, std::size_t indent, std::size_t hanging) {
  std::string out, line(indent, ' ');
  bool empty = true;
  for (const std::string_view word : split(text, ' ')) {
    if (word.empty()) continue;
    if (!empty && columns_of(line) + 1 + columns_of(word) > kTerminalColumns) {
      out += line + "\n";
      line = std::string(hanging, ' ');
      empty = true;
    }
    if (!empty) line += ' ';
    line += word;
    empty = false;
  }
  return empty ? out : out + line + "\n";
}

std::string paragraph_after(std::string_view head, std::string_view text) {
  const std::size_t width = columns_of(head);
  const std::string lines = paragraph(text, width);
  return std::string(head) + (lines.empty() ? "\n" : lines.substr(width));
}

std::string paragraph(std::string_view text, std::size_t indent) { return paragraph(text, indent, indent); }

}  // namespace ecs
