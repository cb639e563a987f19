#include "modules/controllers/part_program.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/findings.hpp"

namespace ecs::controllers {
namespace {

constexpr double kLargestWord = 1e9;
constexpr std::array<std::string_view, 6> kPlainLanguage{"BEGIN PGM", "TOOL CALL", "CYCL DEF",
                                                         "LBL ",      "BLK FORM",  "END PGM"};

constexpr const char* kCommands =
    ": variables, formulas, loops, jumps and calls cannot be corrected; write the moves one by one (CAM systems have "
    "such an option)";

bool is_word_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_word_blank(char c) { return c == ' ' || c == '\t'; }

/// Cuts the code of one line into words.
class LineCutter {
 public:
  LineCutter(ProgramLine& line, bool& semicolons, bool& parentheses, laser::Findings& findings)
      : line_(line), semicolons_(semicolons), parentheses_(parentheses), findings_(findings) {}

  void cut() {
    skip_blanks();
    if (here() == '%' || here() == ':') return;
    if (here() == '/') {
      line_.optional = true;
      ++at_;
    }
    for (skip_blanks(); at_ < line_.text.size(); skip_blanks())
      if (!take()) return;  // what follows is not understood either
  }

 private:
  [[nodiscard]] char here() const { return at_ < line_.text.size() ? line_.text[at_] : '\0'; }
  void skip_blanks() {
    while (is_word_blank(here())) ++at_;
  }
  bool refuse(std::size_t at, const std::string& message) {
    findings_.add(line_.number, static_cast<int>(at) + 1, message);
    return false;
  }

  bool take() {
    const std::size_t start = at_;
    if (here() == ';') {
      semicolons_ = true;
      at_ = line_.text.size();
      return true;
    }
    if (here() == '(') {
      parentheses_ = true;
      at_ = line_.text.find(')', at_);
      if (at_ == std::string::npos)
        return refuse(start, "comment: expected a \")\" before the end of the line, found none");
      ++at_;
      return true;
    }
    return is_word_letter(here()) ? take_word() : refuse_sign(start);
  }

  bool refuse_sign(std::size_t at) {
    const std::string_view sign = std::string_view(line_.text).substr(at, 1);
    const bool formula = std::string_view("#[]=*$@\"<>").find(sign) != std::string_view::npos;
    return refuse(at, "expected a letter and its number, found " + laser::in_quotes(sign) + (formula ? kCommands : ""));
  }

  bool take_word() {
    const std::size_t start = at_;
    std::size_t letters = start;
    while (letters < line_.text.size() && is_word_letter(line_.text[letters])) ++letters;
    if (letters - start > 1) {
      const std::string_view name = std::string_view(line_.text).substr(start, letters - start);
      return refuse(start, "expected a letter and its number, found the command " + laser::in_quotes(name) + kCommands);
    }
    ++at_;
    skip_blanks();
    const std::size_t first = at_;
    while (at_ < line_.text.size() && std::string_view("+-.0123456789").find(here()) != std::string_view::npos) ++at_;
    return keep(start, std::string_view(line_.text).substr(first, at_ - first));
  }

  bool keep(std::size_t start, std::string_view number) {
    const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(line_.text[start])));
    const auto value = number_in(number);
    if (!value || std::abs(*value) > kLargestWord)
      return refuse(start, std::string(1, letter) + ": expected a number such as -50.0 behind it, found " +
                               laser::in_quotes(number.empty() ? std::string_view(line_.text).substr(at_) : number));
    skip_to_equals_sign();
    if (here() == '=') return refuse_sign(at_);
    const std::size_t point = number.find('.');
    const bool has_point = point != std::string_view::npos;
    const auto decimals = has_point ? static_cast<int>(number.size() - point - 1) : 0;
    line_.words.push_back({letter, *value, start, after_ - start, decimals, has_point});
    return true;
  }

  /// Blanks before "=" belong to an assignment: "R1 = 5".
  void skip_to_equals_sign() {
    after_ = at_;
    skip_blanks();
    if (here() != '=') at_ = after_;
  }

  ProgramLine& line_;
  bool& semicolons_;
  bool& parentheses_;
  laser::Findings& findings_;
  std::size_t at_ = 0;
  std::size_t after_ = 0;  ///< behind the last digit of a word
};

/// Lines with their ends.
std::vector<ProgramLine> lines_with_ends(std::string_view text) {
  std::vector<ProgramLine> lines;
  while (!text.empty()) {
    const std::size_t stop = std::min(text.find_first_of("\r\n"), text.size());
    const std::size_t end = stop == text.size() ? 0 : text.substr(stop, 2) == "\r\n" ? 2 : 1;
    ProgramLine line;
    line.number = static_cast<int>(lines.size()) + 1;
    line.text = text.substr(0, stop);
    line.end = text.substr(stop, end);
    lines.push_back(std::move(line));
    text.remove_prefix(stop + end);
  }
  return lines;
}

/// Why the line shows that this is no program to be read; nothing: it may be one.
std::optional<Problem> refused_by(const ProgramLine& line, const std::string& file) {
  if (lower(line.text).find(kCorrectedBy) != std::string::npos)
    return Problem{ProblemKind::refused,
                   "the program has been corrected before; correct the program from which it was made",
                   file,
                   line.number,
                   0,
                   {}};
  const std::string words = upper(line.text.substr(0, line.text.find_first_of("(;")));
  for (const std::string_view mark : kPlainLanguage)
    if (const std::size_t at = words.find(mark); at != std::string::npos)
      return problem_at(file, line.number, static_cast<int>(at) + 1,
                        "expected a part program of ISO 6983 or DIN 66025, found HEIDENHAIN plain language (" +
                            std::string(trimmed(mark)) + "): output an ISO program from the CAM system")
          .value();
  return std::nullopt;
}

}  // namespace

Result<PartProgram> parse_part_program(std::string_view text, const std::string& file) {
  if (auto why = why_no_text(text, file)) return tl::unexpected(std::move(*why));
  PartProgram program;
  program.file = file;
  program.lines = lines_with_ends(text);
  laser::Findings findings(file);
  bool semicolons = false, parentheses = false, any = false;
  std::size_t filled = 0, faulty = 0;
  for (ProgramLine& line : program.lines) {
    if (auto why = refused_by(line, file)) return tl::unexpected(std::move(*why));
    const std::size_t before = findings.count();
    LineCutter(line, semicolons, parentheses, findings).cut();
    if (!trimmed(line.text).empty()) ++filled;
    if (findings.count() > before) ++faulty;
    any = any || !line.words.empty();
    for (std::size_t i = 1; i < line.words.size(); ++i)
      program.spaced = program.spaced || is_word_blank(line.text[line.words[i].at - 1]);
  }
  constexpr std::size_t kFew = 10;  // faults in so few lines are shown one by one
  if (faulty > kFew && 2 * faulty > filled)
    return problem_at(file, 0, 0,
                      "expected a part program of ISO 6983 or DIN 66025, but {} of {} lines are not blocks of "
                      "such a program",
                      faulty, filled);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (!any) return problem_at(file, 0, 0, "expected a part program, found no block");
  program.semicolon_comments = semicolons && !parentheses;
  return program;
}

}  // namespace ecs::controllers
