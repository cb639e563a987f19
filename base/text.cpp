// UTF-8 as RFC 3629 has it: no overlong forms, no surrogates, nothing above U+10FFFF.
#include "base/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace ecs {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\f\v";

std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return text.substr(0, 0);  // callers ask where it lies
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t cut = text.find(separator);
    fields.push_back(text.substr(0, cut));
    if (cut == std::string_view::npos) return fields;
    text.remove_prefix(cut + 1);
  }
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    const bool dos = text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n';
    text.remove_prefix(end + (dos ? 2 : 1));
  }
  return lines;
}

std::vector<NumberedLine> numbered_lines_of(std::string_view text) {
  std::vector<NumberedLine> lines;
  for (const std::string_view line : lines_of(text)) lines.push_back({static_cast<int>(lines.size()) + 1, line});
  return lines;
}

std::vector<std::string_view> blank_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlanks, at)) != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::vector<std::string> owned_lines_of(std::string_view text) {
  const auto lines = lines_of(text);
  return {lines.begin(), lines.end()};
}

std::optional<double> number_in(std::string_view text) {
  text = without_plus(trimmed(text));
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<long long> integer_in(std::string_view text) {
  text = without_plus(trimmed(text));
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool assigns(std::string_view formula) {
  for (std::size_t at = formula.find('='); at != std::string_view::npos; at = formula.find('=', at + 1)) {
    const char before = at > 0 ? formula[at - 1] : ' ';
    const char after = at + 1 < formula.size() ? formula[at + 1] : ' ';
    if (after == '=')
      ++at;
    else if (before != '!' && before != '<' && before != '>')
      return true;
  }
  return false;
}

std::string shortest(double value) { return fmt::format("{}", value); }

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(word.size(), candidate.size());
    if (longer - std::min(word.size(), candidate.size()) >= best_distance) continue;  // the distance is at least that
    const std::size_t distance = edit_distance(lower(word), lower(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

Result<std::uint32_t> whole_number(std::string_view text, std::string_view what) {
  std::string_view digits = trimmed(text);
  const bool hexadecimal = digits.starts_with("0x") || digits.starts_with("0X");
  if (hexadecimal) digits.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
  if (error == std::errc{} && end == digits.data() + digits.size() && !digits.empty()) return value;
  return problem(ProblemKind::usage, "{}: expected a whole number such as 4096 or 0x1000, got \"{}\"", what, text);
}

std::string cell_text(const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

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

std::string shown_line(std::string_view text) {
  std::string line = shown(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
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
