// Which lines of a table are its rows: how a row begins, the rows of one channel, lines that state a target.
// Does not live here: what the cells of a row mean (fields.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
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

}  // namespace ecs::laser
