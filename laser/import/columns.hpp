// Any table of numbers as measurements, by a mapping of its columns that the user gives.
// Does not live here: files whose format is known (import.hpp), keeping a mapping for the next file
// (commissioning/measurements/import_profile.cpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"
#include "laser/units.hpp"

namespace ecs::laser {

/// One field and where it comes from: `FIELD=COLUMN[unit]*factor+offset`, or `date_time=FIRST..LAST`.
struct ColumnRule {
  std::string field;  ///< a column of the measurement CSV, EX … EC, forwardN, reverseN, date_time, or any name to keep
  int column = 0;     ///< from 1; 0: by heading
  int columns = 1;    ///< as many cells, joined by blanks: a date and a time
  std::string heading;  ///< the column's heading, if it is not given by number
  std::optional<Unit> unit;
  double factor = 1.0;  ///< after the unit
  double offset = 0.0;
  bool is_scaled = false;  ///< a factor or an offset was given, be it *1: how the cells are converted is known
  friend bool operator==(const ColumnRule& a, const ColumnRule& b) {
    return a.field == b.field && a.column == b.column && a.columns == b.columns && a.heading == b.heading &&
           a.factor == b.factor && a.offset == b.offset;
  }
};

/// What the readings of the table are.
enum class TableValues {
  errors,            ///< actual − target
  actual_positions,  ///< the error is the position less its target
  compensations      ///< −error
};

/// As `--values` names it; empty: errors, which it means on its own.
[[nodiscard]] constexpr std::string_view option_word(TableValues values) {
  return values == TableValues::actual_positions ? "actual"
         : values == TableValues::compensations  ? "compensation"
                                                 : "";
}

/// What a cell holds.
enum class CellKind {
  any,
  word,  ///< no number
  number,
  date,  ///< 2024-05-06
  time   ///< 09:10:11.5
};

struct ColumnMapping {
  std::vector<ColumnRule> rules;
  bool motion_approach = false;  ///< `approach=motion`: from the order of the targets
  bool no_approach = false;      ///< `approach=none`: it stays unknown
  bool motion_run = false;       ///< `run=motion`: there and back is one run
  int skip_lines = 0;            ///< before the heading row, or the first row if there is no heading
  int most_rows = 0;             ///< 0: all
  char delimiter = '\0';         ///< '\0': found on its own; ' ' stands for any blanks
  char decimal = '\0';           ///< '\0': point or comma, as the delimiter allows
  TableValues values = TableValues::errors;
  std::vector<CellKind> row_begins;  ///< a row begins with such cells; other lines, and values that are no numbers, are
                                     ///< left out and counted. Empty: every line is a row of numbers
  int channel_column = 0;            ///< only the rows of `ImportOptions::channel` in this column, from 1; 0: all rows
  std::optional<Unit> target_lines;  ///< lines such as "3mm" are the targets of the rows below, each of which is a run:
                                     ///< error = value - number of the line, in the unit of the readings
};

/// Reads "x_mm=1[in],reading=3*0.001,run=2,approach=4". Commas part the rules; a heading with commas, blanks or
/// brackets stands in double quotes. Every wrong rule is named.
[[nodiscard]] Result<std::vector<ColumnRule>> column_rules(std::string_view text);

/// A text that is read as the same rules.
[[nodiscard]] std::string rules_text(const std::vector<ColumnRule>& rules);

/// A word in place of a column: `approach=motion`, `approach=none`, `run=motion`, `rows=in_motion`.
[[nodiscard]] bool is_word_rule(const ColumnRule& rule);

/// Rules by heading as rules by number; nothing where one of the headings is not there.
[[nodiscard]] std::optional<std::vector<ColumnRule>> by_number(std::vector<ColumnRule> rules,
                                                               const std::vector<std::string>& headings);

/// The rules of a mapping with `approach=motion`, `approach=none` and `run=motion` set apart.
[[nodiscard]] Result<ColumnMapping> column_mapping(std::string_view text);

/// The name of a sensor by the heading of its column: "t_air_degC" of "T Luft [°C]", "t_3_degC" of column 3 without
/// one.
[[nodiscard]] std::string sensor_named(std::string_view heading, std::size_t number);

/// Reads "word date time any".
[[nodiscard]] Result<std::vector<CellKind>> cell_kinds(std::string_view text);

/// How many lines begin as rows do.
/// @pre the mapping has `row_begins` and `delimiter`
[[nodiscard]] std::size_t rows_begun(std::string_view text, const ColumnMapping& mapping);

/// How a table looks, for the explanation of a file that nothing else reads.
struct TableShape {
  char delimiter = ',';
  std::size_t columns = 0;
  std::vector<bool> is_number;  ///< of each column
  std::size_t rows = 0;         ///< rows of numbers
  int first_row_line = 0;       ///< from 1
  int last_row_line = 0;
  std::size_t lines_between = 0;  ///< lines among the rows that are neither rows nor comments nor empty
  bool is_mixed = false;          ///< lines below the first row hold other numbers: tables of several kinds
  int stretch_line = 0;           ///< where the longest stretch of rows begins
  std::size_t stretch_rows = 0;   ///< how many rows it has
  std::vector<std::string>
      headings;  ///< of the line above the first row, if it has as many words, with a line of units
  std::string first_row;
};

/// The rows of a table that suggested options read.
struct SuggestedRows {
  int skip = 0;           ///< lines before the first row
  std::size_t count = 0;  ///< 0: all
};
[[nodiscard]] SuggestedRows rows_of(const TableShape& shape);

/// Import options for a table that nobody has described, as far as its columns look like a measurement.
struct TableSuggestion {
  SuggestedRows rows{};
  std::string columns{};  ///< "x_mm=1[mm],reading=2[um],approach=motion"
  TableValues values = TableValues::errors;
  std::string sense{};                 ///< "EZ", of a straightness; empty: it follows from the columns
  std::string axis{};                  ///< "X", of readings at one position; empty: it follows from the columns
  std::string parked{};                ///< "x=0"
  std::string reads{};                 ///< in words: "column 1 as targets and column 2 as errors"
  std::vector<std::string> assumed{};  ///< sentences without a full stop: signs, directions, approaches, intervals
  std::string unread{};  ///< a sentence that names every column with numbers that is not read; empty: there is none
};

/// The table in a text that no format reads.
struct FoundTable {
  TableShape shape;
  std::string seems_to_be;  ///< a kind of file that holds no measurements: nothing is suggested; empty: not known
  std::optional<TableSuggestion> suggestion;
};
/// Nothing if the text holds no table of at least two rows.
[[nodiscard]] std::optional<FoundTable> found_table(std::string_view text);

/// The rows like those of the longest stretch of rows: as many cells, at least half of them numbers. Comments and
/// other lines between them do not end the table. Nothing if there is none.
[[nodiscard]] std::optional<TableShape> table_shape(std::string_view text);

/// The headings above a row: the line before it, a comment as well, if it has a word for each column; where these are
/// nothing but units, each behind the heading above it, "Pos [mm]". Empty: there are none.
/// @param first  index of the line of the row
[[nodiscard]] std::vector<std::string> headings_above(const std::vector<std::string_view>& lines, std::size_t first,
                                                      char delimiter, std::size_t columns);

/// A line that begins with '#', '!' or '%', or holds nothing.
[[nodiscard]] bool is_comment(std::string_view line);

/// The cells of a row; double quotes protect delimiters, blanks round cells go.
[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line, char delimiter);

}  // namespace ecs::laser
