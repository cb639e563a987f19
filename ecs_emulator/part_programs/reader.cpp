// From text to blocks: a line is cut into words, a letter and a number each; the words make a block.
#include "ecs_emulator/part_programs/reader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <functional>
#include <initializer_list>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "core/tools.hpp"

namespace ecs::emulator {
namespace {

struct ProgramWord {
  char letter = 'G';  ///< upper case
  double value = 0.0;
  std::string_view text;  ///< as written
  int column = 0;         ///< from 1
};

struct WordProblem {
  int column = 0;
  std::string message;
};

struct WordLine {
  std::vector<ProgramWord> words;
  std::vector<WordProblem> problems;
};

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
      complain(start, fmt::format("{}: {} is out of range", name, number));
    else
      line_.words.push_back({name, *value, code_.substr(start, at_ - start), static_cast<int>(start) + 1});
  }

  std::string_view code_;
  std::size_t at_ = 0;
  WordLine line_;
};

/// The line with comments — from ";" to the end, "(" to ")" — and a leading ">" blanked out, so that columns stay.
/// Complains about a "(" without its ")".
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

/// `code`: without comments. Blanks and tabs mean nothing; numbers have no exponent.
WordLine words_of(std::string_view code) { return WordCutter(code).cut(); }

constexpr double kLongestDwell_s = 86'400.0;
constexpr double kMostRepeats = 1e7;

/// The words of one line put into a block.
class BlockReader {
 public:
  BlockReader(int line, const std::function<void(int, std::string)>& complain) : complain_(complain) {
    block_.line = line;
  }

  ProgramBlock read(const std::vector<ProgramWord>& words) {
    for (const ProgramWord& word : words)
      if (word.letter == 'G' && word.value == 4.0) dwells_ = true;
    for (const ProgramWord& word : words) take(word);
    if (dwells_) check_dwell();
    return block_;
  }

 private:
  void complain(const ProgramWord& word, const std::string& message) { complain_(word.column, message); }

  static bool is_one_of(const ProgramWord& word, std::initializer_list<double> codes) {
    return std::find(codes.begin(), codes.end(), word.value) != codes.end();
  }

  template <class T>
  void set(std::optional<T>& place, T value, const ProgramWord& word, const char* what) {
    if (place) complain(word, fmt::format("{}: a second {} in one block", word.text, what));
    place = value;
  }

  void take(const ProgramWord& word) {
    switch (word.letter) {
      case 'N':
        return;
      case 'G':
        return take_preparatory(word);
      case 'M':
        return take_auxiliary(word);
      case 'X':
      case 'Y':
      case 'Z':
        return take_coordinate(word);
      case 'I':
      case 'J':
      case 'K':
        return set(block_.centre_mm[static_cast<std::size_t>(word.letter - 'I')], word.value, word, "value");
      case 'R':
        return set(block_.radius_mm, word.value, word, "radius");
      case 'H':
      case 'P':
        return take_time(word);
      case 'F':
        if (!(word.value > 0.0)) complain(word, fmt::format("{}: expected a feed above 0 mm/min", word.text));
        return set(block_.feed_mm_min, word.value, word, "feed");
      case 'S':
        if (!(word.value >= 0.0)) complain(word, fmt::format("{}: expected a speed of 0 rpm or more", word.text));
        return set(block_.spindle_rpm, word.value, word, "speed");
      case 'T':
        if (!(word.value >= 0.0 && word.value <= kGreatestToolNumber && word.value == std::floor(word.value)))
          return complain(word, fmt::format("{}: expected a tool number from 0 to {}", word.text, kGreatestToolNumber));
        return set(block_.tool, static_cast<int>(word.value), word, "tool");
      default:
        return complain(
            word, fmt::format("{}: unknown word; expected N G X Y Z I J K R F S T M, or H P with G04", word.text));
    }
  }

  void take_coordinate(const ProgramWord& word) {
    if (dwells_ && word.letter == 'X') return take_time(word);
    set(block_.target_mm[index_of(*axis_of(word.letter))], word.value, word, "value");
  }

  void take_time(const ProgramWord& word) {
    if (!dwells_) return complain(word, fmt::format("{}: only G04 accepts a time", word.text));
    if (!(word.value >= 0.0 && word.value <= kLongestDwell_s))
      complain(word, fmt::format("{}: expected a dwell of 0 to {} s", word.text, kLongestDwell_s));
    set(block_.dwell_s, word.value, word, "time");
  }

  void take_preparatory(const ProgramWord& word) {
    const auto is = [&](std::initializer_list<double> codes) { return is_one_of(word, codes); };
    if (is({0, 1, 2, 3})) return set(block_.motion, static_cast<ProgramMotion>(word.value), word, "motion");
    if (is({17, 18, 19})) return set(block_.plane, static_cast<Plane>(word.value - 17), word, "plane");
    if (is({90, 91})) return set(block_.incremental, word.value == 91, word, "G90 or G91");
    if (is({9})) block_.exact_stop = true;
    if (is({4, 9, 21, 71, 94})) return;  // 21 … 94: millimetres, millimetres per minute: nothing else is known here
    complain(word, fmt::format("{}: unknown; expected G00 G01 G02 G03 G04 G09 G17 G18 G19 G21 G71 G90 G91 or G94",
                               word.text));
  }

  void take_auxiliary(const ProgramWord& word) {
    const auto is = [&](std::initializer_list<double> codes) { return is_one_of(word, codes); };
    if (is({3, 4, 5})) return set(block_.spindle, is({3}) ? 1 : is({4}) ? -1 : 0, word, "spindle word");
    if (is({8, 9})) return set(block_.trigger, is({8}), word, "M08 or M09");
    if (is({0})) block_.stop = true;
    if (is({2, 30})) block_.end = true;
    if (is({6})) block_.tool_change = true;
    if (is({0, 2, 6, 30})) return;
    complain(word, fmt::format("{}: unknown; expected M00 M02 M03 M04 M05 M06 M08 M09 or M30", word.text));
  }

  void check_dwell() {
    if (!block_.dwell_s) complain_(1, "G04: expected its time in seconds, such as G04H2");
    if (block_.moves() || block_.has_centre() || block_.radius_mm || block_.motion)
      complain_(1, "G04: expected a block of its own, without motion");
  }

  const std::function<void(int, std::string)>& complain_;
  ProgramBlock block_;
  bool dwells_ = false;
};

class ProgramReader {
 public:
  explicit ProgramReader(const std::string& file) { program_.file = file; }

  Result<Program> read(std::string_view text) {
    if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
    const auto lines = lines_of(text);
    if (lines.size() > kProgramLines)
      complain_at(0, 0, fmt::format("expected at most {} lines, got {}", kProgramLines, lines.size()));
    for (const std::string_view line : lines) {
      ++line_;
      if (problems_.size() >= kProgramProblems) break;
      take(line);
    }
    for (const std::size_t open : open_)
      complain_at(program_.blocks[open].line, 1, "$REP: expected its $END before the end of the program");
    if (problems_.empty() && program_.blocks.empty())
      complain_at(std::max(line_, 1), 1, "expected a part program, found no block");
    if (problems_.empty()) return std::move(program_);
    return tl::unexpected(folded(std::move(problems_)));
  }

 private:
  void complain_at(int line, int column, std::string message) {
    problems_.push_back({ProblemKind::bad_input, std::move(message), program_.file, line, column, {}});
  }
  void complain(int column, std::string message) { complain_at(line_, column, std::move(message)); }

  void take(std::string_view line) {
    std::vector<WordProblem> problems;
    const std::string code = without_comments(line, problems);
    for (WordProblem& found : problems) complain(found.column, std::move(found.message));
    const std::string_view rest = trimmed(code);
    if (rest.empty() || rest.front() == '%') return;
    if (rest.front() == '$') return take_loop(rest, static_cast<int>(code.find('$')) + 1);
    WordLine words = words_of(code);
    for (WordProblem& found : words.problems) complain(found.column, std::move(found.message));
    if (!words.problems.empty() || words.words.empty()) return;
    program_.blocks.push_back(BlockReader(line_, complain_).read(words.words));
  }

  /// @param code  from "$" on
  void take_loop(std::string_view code, int column) {
    const std::string word = lower(code.substr(0, 4));
    const std::string_view rest = trimmed(code.substr(std::min<std::size_t>(4, code.size())));
    if (word == "$rep") return open_loop(rest, column);
    if (word != "$end" || !rest.empty())
      return complain(column, fmt::format("expected \"$REP n\" or \"$END\", got \"{}\"", shown(code)));
    if (open_.empty()) return complain(column, "$END: expected a $REP before it");
    ProgramBlock block;
    block.line = line_;
    block.loop_end = true;
    block.partner = open_.back();
    program_.blocks[open_.back()].partner = program_.blocks.size();
    open_.pop_back();
    program_.blocks.push_back(block);
  }

  void open_loop(std::string_view count, int column) {
    const auto times = integer_in(count);
    if (!times || *times < 1 || static_cast<double>(*times) > kMostRepeats)
      complain(column,
               fmt::format("$REP: expected a whole number from 1 to {:.0f}, got \"{}\"", kMostRepeats, shown(count)));
    if (open_.size() == kProgramDepth)
      complain(column, fmt::format("$REP: expected at most {} nested loops", kProgramDepth));
    ProgramBlock block;
    block.line = line_;
    block.repeat = times && *times > 0 ? *times : 1;
    open_.push_back(program_.blocks.size());
    program_.blocks.push_back(block);
  }

  static std::string shown(std::string_view text) {
    std::string printable(text.substr(0, 20));
    for (char& c : printable)
      if (std::isprint(static_cast<unsigned char>(c)) == 0) c = '?';
    return printable;
  }

  Program program_;
  std::vector<std::size_t> open_;  ///< places of the loops that have begun
  std::vector<Problem> problems_;
  int line_ = 0;
  const std::function<void(int, std::string)> complain_ = [this](int column, std::string message) {
    complain(column, std::move(message));
  };
};

}  // namespace

Result<Program> parse_program(std::string_view text, const std::string& file) { return ProgramReader(file).read(text); }

Result<Program> read_program(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_program(text, path.string());
}

}  // namespace ecs::emulator
