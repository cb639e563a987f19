// The rows of a table as readings, by the fields of its plan; what the rows together say of approach, run and time.
// Does not live here: which lines are rows (rows.hpp, columns_reader.cpp), channels over time (channels.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "laser/findings.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/rows.hpp"

namespace ecs::laser {

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
