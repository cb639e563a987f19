// Sentences broken into lines that fit a terminal.
// Does not live here: characters that a terminal must not receive (shown.hpp).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ecs {

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

}  // namespace ecs
