// Which lines of a table are its rows (how a row begins, the rows of one channel, lines that state a target), and the
// rows as readings, by the fields of their plan; what the rows together say of approach, run and time. Does not live
// here: what the cells of a row mean (fields.hpp), channels over time (channels.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/findings.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/import.hpp"

namespace ecs::laser {

/// A target that a line between the rows states.
struct StatedTarget {
  double number = 0.0;  ///< as written
  double mm = 0.0;
};

struct TableRow {
  int number = 0;  ///< of its line in the file, from 1
  std::string_view line;
  std::vector<std::string_view> cells;
  std::optional<StatedTarget> target;  ///< of the last line above that states one
  int block = 0;                       ///< how many such lines are above
};

[[nodiscard]] bool begins_as(const std::vector<CellKind>& kinds, const std::vector<std::string_view>& cells);

/// The target that a line states by a number and the unit of `target_lines`, as in "3mm"; nothing for other lines.
/// `target_unit` of the options wins over the unit.
[[nodiscard]] std::optional<StatedTarget> target_stated(std::string_view line, const ImportOptions& options);

/// Keeps the rows of the channel asked for, or of the only one. A `usage` problem lists the channels with their numbers
/// of rows otherwise.
/// @return the channel; empty without a column of channels, and without rows
/// @pre options.mapping
[[nodiscard]] Result<std::string> keep_channel(std::vector<TableRow>& rows, const std::string& file_name,
                                               const ImportOptions& options);

[[nodiscard]] std::vector<Field> fields_of(const std::vector<ColumnRule>& rules);

/// Gives the plan the axis of a table that maps one position, or one angle, and nothing that says more.
void take_mapped_axis(Plan& plan);

/// The cells of a field, joined by blanks. @pre field.last() < cells.size()
[[nodiscard]] std::string joined_cells(const std::vector<std::string_view>& cells, const Field& field);

/// One row: its readings go to `set`.
/// @return values that are left out
int take_row(MeasurementSet& set, const Plan& plan, const TableRow& row, int run, Findings& findings);

/// Counts time from the first reading; where that is a date, it is kept as metadata (kBegun).
void begin_at_zero(MeasurementSet& set);

/// Approach and run from the motion or the order of repeats, time from the first reading, the numbers of the rows;
/// what was assumed goes into the notes.
void finish(MeasurementSet& set, const ColumnMapping& mapping, const Plan& plan);

}  // namespace ecs::laser
