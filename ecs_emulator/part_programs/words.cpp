#include "ecs_emulator/part_programs/words.hpp"

#include <cctype>
#include <charconv>

#include <fmt/format.h>

namespace ecs::emulator {
namespace {

constexpr double kLargest = 1e9;  ///< no number of a part program is larger

bool blank(char c) { return c == ' ' || c == '\t'; }
bool letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool of_number(char c) { return digit(c) || c == '+' || c == '-' || c == '.'; }

std::string shown(char c) {
  const auto code = static_cast<unsigned char>(c);
  return code >= 0x20 && code < 0x7f ? fmt::format("\"{}\"", c) : fmt::format("byte 0x{:02x}", code);
}

/// Sign, digits, point: anything else is no number of this language.
std::optional<double> value_of(std::string_view text) {
  const bool plus = !text.empty() && text.front() == '+';
  const std::string_view rest = text.substr(plus ? 1 : 0);
  if (rest.find_first_of("0123456789") == rest.npos || (plus && rest.front() == '-')) return std::nullopt;
  double value = 0.0;
  const auto [end, code] = std::from_chars(rest.data(), rest.data() + rest.size(), value, std::chars_format::fixed);
  if (code != std::errc() || end != rest.data() + rest.size()) return std::nullopt;
  return value;
}

/// Takes one word, and skips what cannot be one.
class WordCutter {
 public:
  explicit WordCutter(std::string_view code) : code_(code) {}

  WordLine cut() {
    while (skip_blanks()) {
      const std::size_t start = at_;
      if (letter(code_[at_])) {
        take_word();
        continue;
      }
      complain(start, fmt::format("expected a letter and its number, got {}", shown(code_[at_])));
      while (at_ < code_.size() && !letter(code_[at_])) ++at_;
    }
    return std::move(line_);
  }

 private:
  bool skip_blanks() {
    while (at_ < code_.size() && blank(code_[at_])) ++at_;
    return at_ < code_.size();
  }
  void complain(std::size_t at, std::string message) {
    line_.problems.push_back({static_cast<int>(at) + 1, std::move(message)});
  }

  void take_word() {
    const std::size_t start = at_;
    const char name = static_cast<char>(std::toupper(static_cast<unsigned char>(code_[at_++])));
    skip_blanks();
    const std::size_t first = at_;
    while (at_ < code_.size() && of_number(code_[at_])) ++at_;
    const std::string_view number = code_.substr(first, at_ - first);
    const auto value = value_of(number);
    if (!value)
      complain(start, number.empty() ? fmt::format("{}: expected a number after it", name)
                                     : fmt::format("{}: expected a number such as -50.0, got \"{}\"", name, number));
    else if (*value > kLargest || *value < -kLargest)
      complain(start, fmt::format("{}: {} is out of all bounds", name, number));
    else
      line_.words.push_back({name, *value, code_.substr(start, at_ - start), static_cast<int>(start) + 1});
  }

  std::string_view code_;
  std::size_t at_ = 0;
  WordLine line_;
};

}  // namespace

std::string without_comments(std::string_view line, std::vector<WordProblem>& problems) {
  std::string code(line);
  for (std::size_t at = code.find_first_of("(;"); at != code.npos; at = code.find_first_of("(;", at)) {
    const std::size_t close = code[at] == '(' ? code.find(')', at) : code.size();
    if (close == code.npos)
      problems.push_back({static_cast<int>(at) + 1, "comment: expected a \")\" before the end of the line"});
    for (; at < code.size() && at <= close; ++at) code[at] = ' ';
  }
  const std::size_t first = code.find_first_not_of(" \t");
  if (first != code.npos && code[first] == '>') code[first] = ' ';
  return code;
}

WordLine words_of(std::string_view code) { return WordCutter(code).cut(); }

}  // namespace ecs::emulator
