// Part programs of ISO 6983 / DIN 66025 as text: lines that keep every byte, cut into words, a letter and a number
// each. Does not live here: what the words do and how they are corrected (corrected_program.hpp).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs::controllers {

/// "X-12.5"
struct ProgramWord {
  char letter = 'G';      ///< upper case
  double value = 0.0;     ///< as written, in the unit of the program; at most 1e9 by size
  std::size_t at = 0;     ///< of its letter in the line
  std::size_t size = 0;   ///< to the last digit
  int decimals = 0;       ///< digits behind the decimal point
  bool has_point = true;  ///< false: "X100"
};

struct ProgramLine {
  int number = 0;                  ///< of the file, from 1
  std::string text;                ///< without its end
  std::string end;                 ///< LF, CRLF, CR; nothing at the end of the file
  std::vector<ProgramWord> words;  ///< in their order; none in comments, and none in a line % or :1234
  bool optional = false;           ///< it begins with "/": skipped where the operator chooses so
  [[nodiscard]] std::string_view text_of(const ProgramWord& word) const {
    return std::string_view(text).substr(word.at, word.size);
  }
};

struct PartProgram {
  std::string file;
  std::vector<ProgramLine> lines;
  bool spaced = false;              ///< there are blanks between words
  bool semicolon_comments = false;  ///< its comments begin with ";", none is in parentheses
};

/// How the comment begins that a corrected program has; behind it stands what it was corrected for.
inline constexpr std::string_view kCorrectedBy = "corrected by ecs export program";

/// Comments are "( … )" and "; …"; blanks between a letter and its number are allowed. Refused, every line with its
/// column (the first 20): variables, formulas, commands in words (loops, jumps, calls), a letter without a number, a
/// comment without its end; programs of HEIDENHAIN in plain language; `refused`: a program that was corrected before.
[[nodiscard]] Result<PartProgram> parse_part_program(std::string_view text, const std::string& file);

}  // namespace ecs::controllers
