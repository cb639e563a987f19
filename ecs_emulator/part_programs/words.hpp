// One line of a part program cut into words: a letter and a number each; the resolution of coordinates.
#pragma once

#include <cmath>
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

/// Coordinates that add up are kept to the nanometre: sums of incremental moves stay what a hand would add up, 3 times
/// −0.1 is −0.3.
[[nodiscard]] inline double to_nanometre(double mm) { return std::round(mm * 1e6) / 1e6; }

/// The line with comments — from ";" to the end, "(" to ")" — and a leading ">" blanked out, so that columns stay.
/// Complains about a "(" without its ")".
[[nodiscard]] std::string without_comments(std::string_view line, std::vector<WordProblem>& problems);

/// `code`: without comments. Blanks and tabs mean nothing; numbers have no exponent.
[[nodiscard]] WordLine words_of(std::string_view code);

}  // namespace ecs::emulator
