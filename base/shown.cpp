// UTF-8 as RFC 3629 has it: no overlong forms, no surrogates, nothing above U+10FFFF.
#include "base/shown.hpp"

#include <cstdint>

#include <fmt/format.h>

namespace ecs {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: no UTF-8
};

bool in(std::uint32_t code, std::uint32_t first, std::uint32_t last) { return code >= first && code <= last; }

/// @pre text is not empty
Character first_character(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = in(lead, 0xC2, 0xDF) ? 2 : in(lead, 0xE0, 0xEF) ? 3 : in(lead, 0xF0, 0xF4) ? 4 : 0;
  if (bytes == 0 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0xFFu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!in(byte(i), 0x80, 0xBF)) return {};
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  if (overlong || in(code, 0xD800, 0xDFFF) || code > 0x10FFFF) return {};
  return {code, bytes};
}

bool is_obeyed(std::uint32_t code) {
  const bool control = (code < 0x20 && code != '\n' && code != '\t') || in(code, 0x7F, 0x9F);
  const bool turns_writing = in(code, 0x200E, 0x200F) || in(code, 0x202A, 0x202E) || in(code, 0x2066, 0x2069);
  return control || turns_writing || in(code, 0x2028, 0x2029);
}

}  // namespace

std::string shown(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::size_t bytes = character.bytes == 0 ? 1 : character.bytes;
    if (character.bytes == 0 || is_obeyed(character.code))
      out += '?';
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

std::string shown_json(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  while (!json.empty()) {
    const Character character = first_character(json);
    const std::size_t bytes = character.bytes == 0 ? 1 : character.bytes;
    if (character.code >= 0x7F && is_obeyed(character.code))  // below it JSON has its own escapes
      out += fmt::format("\\u{:04x}", character.code);
    else
      out += json.substr(0, bytes);
    json.remove_prefix(bytes);
  }
  return out;
}

std::string cut_line(std::string_view line, std::size_t most) {
  if (line.size() <= most) return std::string(line);
  std::size_t end = most;
  while (end > 0 && (static_cast<std::uint8_t>(line[end]) & 0xC0U) == 0x80U) --end;  // between characters
  return fmt::format("{}… (cut: {} bytes)", line.substr(0, end), line.size());
}

}  // namespace ecs
