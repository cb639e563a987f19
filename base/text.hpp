// Text as files hold it: trimming, splitting, numbers. Always in the "C" locale, whatever the terminal says.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ecs {

/// Without blanks, tabs, CR and LF at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// ASCII lower case.
[[nodiscard]] std::string lower(std::string_view text);

/// ASCII upper case.
[[nodiscard]] std::string upper(std::string_view text);

/// Cut at every `separator`; "a,,b" has three fields, "" has one.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

/// Lines without their ends; LF, CRLF and CR all end a line. The last line needs no end.
[[nodiscard]] std::vector<std::string_view> lines_of(std::string_view text);

/// The same with their numbers, from 1.
struct NumberedLine {
  int number = 0;
  std::string_view text;
};
[[nodiscard]] std::vector<NumberedLine> numbered_lines_of(std::string_view text);

/// The words between blanks and tabs.
[[nodiscard]] std::vector<std::string_view> blank_words(std::string_view text);

/// The lines, as strings of their own.
[[nodiscard]] std::vector<std::string> owned_lines_of(std::string_view text);

/// The whole of `text` (blanks around it allowed, leading '+' allowed) as a finite decimal number; else nothing.
[[nodiscard]] std::optional<double> number_in(std::string_view text);

/// The whole of `text` as a decimal integer; else nothing.
[[nodiscard]] std::optional<long long> integer_in(std::string_view text);

/// Whether a formula in the notation of muParser assigns (=, +=, …); a comparison (==, <=, …) does not.
[[nodiscard]] bool assigns(std::string_view formula);

/// Shortest decimal that reads back as the same double ("0.1", "-38.8", "1e-07").
[[nodiscard]] std::string shortest(double value);

/// The candidate most like `word` (edit distance at most a third of its length), for "did you mean"; empty if none.
[[nodiscard]] std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace ecs
