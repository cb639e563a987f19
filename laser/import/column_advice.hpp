// Which columns of an unknown table could be positions and readings, and the options that read it so.
#pragma once

#include <string>
#include <string_view>

#include "laser/import/columns.hpp"

namespace ecs::laser {

/// Suggested is a column of positions that rises or falls over stretches, with a column of errors beside it that are
/// small against its travel, or of actual positions close to it; or readings over time. Where no columns are like that
/// the answer names the columns, and how to say which is what.
/// @param known  the file is of a kind that holds no measurements: nothing is suggested
[[nodiscard]] std::string column_advice(std::string_view text, const TableShape& shape, bool known);

}  // namespace ecs::laser
