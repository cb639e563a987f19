// The shape of an unknown table: delimiter, columns, where its rows are.
#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/fields.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

bool is_number(std::string_view cell) { return number_or_comma(cell).has_value(); }

std::size_t numbers_among(const std::vector<std::string_view>& cells) {
  return static_cast<std::size_t>(std::ranges::count_if(cells, is_number));
}

/// A row of a table: two cells or more, at least half of them numbers.
bool is_row(const std::vector<std::string_view>& cells) {
  const std::size_t numbers = numbers_among(cells);
  return cells.size() >= 2 && numbers >= 1 && 2 * numbers >= cells.size();
}

struct TableLine {
  std::size_t index = 0;
  std::vector<std::string_view> cells;
};

/// The lines that may be rows, comments and empty lines left out.
std::vector<TableLine> lines_with(const std::vector<std::string_view>& lines, char delimiter) {
  std::vector<TableLine> kept;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!is_comment(lines[i])) kept.push_back({i, cells_of(lines[i], delimiter)});
  return kept;
}

/// As many cells, numbers in the same ones; empty cells are of either kind.
bool same_kinds(const std::vector<std::string_view>& a, const std::vector<std::string_view>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](std::string_view one, std::string_view other) {
    return one.empty() || other.empty() || is_number(one) == is_number(other);
  });
}

/// The longest stretch of rows of the same kinds of cells; empty if there is none.
std::span<const TableLine> longest_stretch(const std::vector<TableLine>& lines) {
  auto best = lines.end();
  std::ptrdiff_t most = 0;
  for (auto first = lines.begin(); first != lines.end();) {
    const auto end = std::find_if(first, lines.end(), [&](const TableLine& line) {
      return !is_row(line.cells) || !same_kinds(line.cells, first->cells);
    });
    if (end - first > most) {
      most = end - first;
      best = first;
    }
    first = end == first ? first + 1 : end;
  }
  return std::span(lines).subspan(static_cast<std::size_t>(best - lines.begin()), static_cast<std::size_t>(most));
}

/// As wide as the model, with numbers where it has some; a number may be missing.
bool is_like(const std::vector<std::string_view>& cells, const std::vector<std::string_view>& model) {
  if (cells.size() != model.size() || !is_row(cells)) return false;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_number(model[i]) && !is_number(cells[i]) && !cells[i].empty()) return false;
  return true;
}

/// A cell of a line of units, "[mm]" or "mm"; the unit without brackets, or nothing.
std::string_view bare_unit(std::string_view cell) {
  const auto unit = unit_in_heading("in [" + std::string(cell) + "]");
  if (unit) return cell;
  if (cell.size() > 2 && (cell.front() == '[' || cell.front() == '(') && unit_in_heading("in " + std::string(cell)))
    return trimmed(cell.substr(1, cell.size() - 2));
  return {};
}

std::optional<TableShape> shape_with(const std::vector<std::string_view>& lines, char delimiter) {
  const auto candidates = lines_with(lines, delimiter);
  const auto stretch = longest_stretch(candidates);
  if (stretch.empty()) return std::nullopt;
  const auto& model = stretch.front().cells;
  TableShape shape;
  shape.delimiter = delimiter;
  shape.columns = model.size();
  shape.stretch_line = static_cast<int>(stretch.front().index) + 1;
  shape.stretch_rows = stretch.size();
  shape.is_number.assign(shape.columns, false);
  std::size_t others = 0;  // since the last row
  for (const TableLine& line : candidates) {
    if (!is_like(line.cells, model)) {
      shape.is_mixed = shape.is_mixed || (shape.rows > 0 && numbers_among(line.cells) > 0);
      ++others;
      continue;
    }
    if (shape.rows == 0) {
      shape.first_row_line = static_cast<int>(line.index) + 1;
      shape.first_row = std::string(trimmed(lines[line.index]));
    } else {
      shape.lines_between += others;
    }
    for (std::size_t i = 0; i < shape.columns; ++i) shape.is_number[i] = shape.is_number[i] || is_number(line.cells[i]);
    others = 0;
    ++shape.rows;
    shape.last_row_line = static_cast<int>(line.index) + 1;
  }
  shape.headings = headings_above(lines, static_cast<std::size_t>(shape.first_row_line) - 1, delimiter, shape.columns);
  return shape;
}

}  // namespace

bool is_comment(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.starts_with('#') || text.starts_with('!') || text.starts_with('%');
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  if (delimiter == ' ') return blank_words(line);
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

std::vector<std::string> headings_above(const std::vector<std::string_view>& lines, std::size_t first, char delimiter,
                                        std::size_t columns) {
  std::vector<std::string_view> units;
  while (first-- > 0) {
    std::string_view line = trimmed(lines[first]);
    if (line.empty()) continue;
    if (is_comment(line)) line.remove_prefix(std::min(line.find_first_not_of("#!%"), line.size()));
    const auto cells = cells_of(line, delimiter);
    const bool fits = cells.size() == columns && numbers_among(cells) == 0;
    const bool is_units =
        fits && std::ranges::any_of(cells, [](auto cell) { return !cell.empty(); }) &&
        std::ranges::all_of(cells, [](auto cell) { return cell.empty() || cell == "-" || !bare_unit(cell).empty(); });
    if (units.empty() && is_units) {
      units = cells;
      continue;
    }
    std::vector<std::string> headings;
    if (fits) headings.assign(cells.begin(), cells.end());
    if (headings.empty()) headings.assign(units.size(), "");
    for (std::size_t i = 0; i < units.size(); ++i)
      if (const auto unit = bare_unit(units[i]); !unit.empty())
        headings[i] += fmt::format("{}[{}]", headings[i].empty() ? "" : " ", unit);
    return headings;
  }
  return {units.begin(), units.end()};
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
