// A table of an answer whose columns are stated once: the objects of its JSON and the lines of its text come from them.
// Answers in prose keep their own text. Only for .cpp files (heavy header).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json.hpp"

namespace ecs {

/// One value as JSON holds it and as a terminal shows it.
struct Cell {
  Json json;
  std::string text;
};

/// "1.234"; null and "-" where there is none.
[[nodiscard]] Cell number_cell(const std::optional<double>& value, int decimals);
[[nodiscard]] Cell count_cell(std::size_t count);
[[nodiscard]] Cell word_cell(std::string_view word);
/// true or false, shown as one of two words.
[[nodiscard]] Cell yes_cell(bool yes, std::string_view when_true, std::string_view when_false);
/// Shown only; JSON has no such key.
[[nodiscard]] Cell shown_cell(std::string text);

using CellTexts = std::vector<std::pair<std::string_view, std::string>>;  ///< by key

/// One line of text. @param layout  as fmt takes it, a column by its key: "{axis:<4} {position_mm:>11}"
[[nodiscard]] std::string laid_out(std::string_view layout, const CellTexts& cells);

template <class Row>
struct AnswerColumn {
  std::string_view key;      ///< in JSON and in the layout
  std::string_view heading;  ///< of the text; empty where the layout does not name the column
  std::function<Cell(const Row&)> cell;
};

/// JSON keys come in the order of the columns; the text shows those that its layout names, in the layout's order.
template <class Row>
class AnswerTable {
 public:
  AnswerTable(std::string_view layout, std::vector<AnswerColumn<Row>> columns)
      : layout_(layout), columns_(std::move(columns)) {}

  [[nodiscard]] std::string heading() const {
    CellTexts cells;
    for (const auto& column : columns_) cells.emplace_back(column.key, std::string(column.heading));
    return laid_out(layout_, cells);
  }
  [[nodiscard]] std::string line(const Row& row) const {
    CellTexts cells;
    for (const auto& column : columns_) cells.emplace_back(column.key, column.cell(row).text);
    return laid_out(layout_, cells);
  }
  [[nodiscard]] Json object(const Row& row) const {
    Json object = Json::object();
    for (const auto& column : columns_)
      if (Cell cell = column.cell(row); !cell.json.is_discarded())
        object[std::string(column.key)] = std::move(cell.json);
    return object;
  }

  template <class Rows>
  [[nodiscard]] std::string text(const Rows& rows) const {
    std::string text = heading();
    for (const Row& row : rows) text += line(row);
    return text;
  }
  template <class Rows>
  [[nodiscard]] Json array(const Rows& rows) const {
    Json array = Json::array();
    for (const Row& row : rows) array.push_back(object(row));
    return array;
  }

 private:
  std::string_view layout_;
  std::vector<AnswerColumn<Row>> columns_;
};

}  // namespace ecs
