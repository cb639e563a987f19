// One line of a part program cut into words: a letter and a number each. For reader.cpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ecs::emulator {

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

/// The line with comments — from ";" to the end, "(" to ")" — and a leading ">" blanked out, so that columns stay.
/// Complains about a "(" without its ")".
[[nodiscard]] std::string without_comments(std::string_view line, std::vector<WordProblem>& problems);

/// `code`: without comments. Blanks and tabs mean nothing; numbers have no exponent.
[[nodiscard]] WordLine words_of(std::string_view code);

}  // namespace ecs::emulator
