// Text as files, users and terminals have it: trimming, splitting, numbers in the "C" locale, whatever the terminal
// says; sentences broken into lines; text of files and units as a terminal may see it. Does not live here: JSON
// (json.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

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

/// "0x100000" or "1048576": a whole number of 32 bits, else a usage problem that names `what`.
[[nodiscard]] Result<std::uint32_t> whole_number(std::string_view text, std::string_view what);

/// "1.234", or "-" where there is none: a cell of a table.
[[nodiscard]] std::string cell_text(const std::optional<double>& value);

inline constexpr std::size_t kTerminalColumns = 80;

/// `text` broken at blanks into lines of at most 80 columns, each with its line end. A word longer than a line stays
/// whole. @param indent  blanks before the first line @param hanging  blanks before the others
[[nodiscard]] std::string paragraph(std::string_view text, std::size_t indent, std::size_t hanging);
[[nodiscard]] std::string paragraph(std::string_view text, std::size_t indent = 0);

/// `head` in one piece, such as the first cells of a row, then `text` in lines that begin where it ends.
[[nodiscard]] std::string paragraph_after(std::string_view head, std::string_view text);

/// Columns that UTF-8 text takes on a terminal, one for each character.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// At least `width` columns, blanks at the end.
[[nodiscard]] std::string padded(std::string_view text, std::size_t width);

/// The same text, with nothing in it that a terminal would act on: control characters (C0 without line feed and tab,
/// DEL, C1), marks that turn the direction of writing, and bytes that are no UTF-8 each become '?'. Valid UTF-8 stays.
[[nodiscard]] std::string shown(std::string_view text);

/// The same as one line of a file: line ends become blanks.
[[nodiscard]] std::string shown_line(std::string_view text);

/// JSON with the same characters as escapes (\u009b) in place of bytes; what it means stays. @param json  valid, UTF-8
[[nodiscard]] std::string shown_json(std::string_view json);

/// A line of at most this many bytes; of a longer one the beginning and how long it is.
[[nodiscard]] std::string cut_line(std::string_view line, std::size_t most);

}  // namespace ecs
