// The shape of an unknown table: delimiter, columns, where its rows begin.
#include <algorithm>
#include <array>

#include "base/text.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/renishaw_file.hpp"

namespace ecs::laser {
namespace {

std::size_t numbers_among(const std::vector<std::string_view>& cells) {
  return static_cast<std::size_t>(std::count_if(
      cells.begin(), cells.end(), [](std::string_view cell) { return number_or_comma(cell).has_value(); }));
}

/// A row of a table: two cells or more, at least half of them numbers.
bool is_row(const std::vector<std::string_view>& cells) {
  const std::size_t numbers = numbers_among(cells);
  return cells.size() >= 2 && numbers >= 1 && 2 * numbers >= cells.size();
}

std::optional<TableShape> shape_with(const std::vector<std::string_view>& lines, char delimiter) {
  TableShape best;
  std::size_t run = 0;
  std::size_t width = 0;
  std::size_t first = 0;
  const auto keep = [&] {
    if (run > best.rows) best = {delimiter, width, run, static_cast<int>(first) + 1, {}, {}};
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const auto cells = cells_of(lines[i], delimiter);
    const bool row = is_row(cells);
    if (row && cells.size() == width && run > 0) {
      ++run;
      continue;
    }
    keep();
    run = row ? 1 : 0;
    width = cells.size();
    first = i;
  }
  keep();
  if (best.rows == 0) return std::nullopt;
  const auto begin = static_cast<std::size_t>(best.first_row_line) - 1;
  best.first_row = std::string(trimmed(lines[begin]));
  if (begin > 0) {
    const auto above = cells_of(lines[begin - 1], delimiter);
    if (above.size() == best.columns && numbers_among(above) == 0) best.headings.assign(above.begin(), above.end());
  }
  return best;
}

}  // namespace

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  if (delimiter == ' ') return words_of(line);
  std::vector<std::string_view> cells;
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != delimiter)) continue;
    std::string_view cell = trimmed(line.substr(start, i - start));
    if (cell.size() >= 2 && cell.starts_with('"') && cell.ends_with('"')) cell = cell.substr(1, cell.size() - 2);
    cells.push_back(cell);
    start = i + 1;
  }
  return cells;
}

std::optional<TableShape> table_shape(std::string_view text) {
  constexpr std::array<char, 5> kDelimiters{';', '\t', '|', ',', ' '};
  const auto lines = lines_of(text);
  std::optional<TableShape> best;
  for (const char delimiter : kDelimiters) {
    const auto shape = shape_with(lines, delimiter);
    if (shape && (!best || shape->rows > best->rows)) best = shape;
  }
  return best;
}

}  // namespace ecs::laser
