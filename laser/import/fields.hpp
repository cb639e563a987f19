// What each mapped column of a table is, how one cell of it enters a reading, and the unit that its heading states.
// Does not live here: rows (rows.hpp), files and the mapping as it is typed (columns.cpp), the units themselves
// (laser/units.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "laser/import/columns.hpp"
#include "laser/import/import.hpp"
#include "laser/measurement_set.hpp"
#include "laser/units.hpp"

namespace ecs::laser {

/// "forward3" is forward, run 3; "forward" is of the run of its row.
struct Pass {
  Approach approach = Approach::unknown;
  int run = 0;  ///< 0: none is named
};

/// Nothing for other fields.
[[nodiscard]] std::optional<Pass> pass_named(std::string_view field);

/// What a field does with its cell.
enum class Role {
  position,
  angle,   ///< a_deg, b_deg, c_deg: of a rotary axis
  target,  ///< of the axis that the row names
  error,
  own_sense,
  pass,
  measured,  ///< measured_x_mm: where a nominal position was found; tip_x_mm: where the control saw a ball
  axis,
  sense,
  approach,
  date_time,
  other
};

struct Field {
  ColumnRule rule;
  Role role = Role::other;
  std::size_t index = 0;  ///< of the column, from 0
  [[nodiscard]] std::size_t last() const { return index + static_cast<std::size_t>(rule.columns - 1); }
};

/// The direction of "measured_x_mm" or "tip_x_mm".
[[nodiscard]] std::optional<Axis> measured_direction(std::string_view field);

/// "tip_x_mm": the tool centre point that the control shows while the probe is at a ball.
[[nodiscard]] bool is_tip(std::string_view field);

/// The column of the point that a row measures, where no nominal positions are mapped.
inline constexpr std::string_view kPointColumn = "point";

[[nodiscard]] Role role_of(std::string_view field);

/// The field gives a reading.
[[nodiscard]] bool is_value(Role role);

[[nodiscard]] bool has_role(const std::vector<Field>& fields, Role role);

/// Everything about the table that is the same for all rows.
struct Plan {
  std::vector<Field> fields;
  std::optional<Axis> axis;
  bool rotary = false;  ///< that axis turns
  std::optional<Sense> sense;
  TableValues values = TableValues::errors;
  char decimal = '\0';
  Vector3 parked_mm{};  ///< of the axes whose place is not mapped
  PerAxis<bool> parked_stated{};
  bool leaves_words = false;  ///< values that are no numbers are left out
};

/// Gives positions and values without a unit those of the options; what is wrong with these units, or nothing.
[[nodiscard]] std::string take_units(Plan& plan, const ImportOptions& options);

/// What is wrong with the mapping as a whole, or nothing.
[[nodiscard]] std::string plan_fault(const Plan& plan);

/// A cell as a number, decimal comma as the plan allows.
[[nodiscard]] std::optional<double> cell_number(const Plan& plan, std::string_view cell);

/// Sets the error of a reading whose axis, sense and position are known; what is wrong, or nothing.
[[nodiscard]] std::string set_error(Reading& reading, const Plan& plan, const Field& field, double cell);

/// What a field does to the reading that all readings of its row begin with; what is wrong, or nothing.
/// @pre !is_value(field.role), and no target
[[nodiscard]] std::string set_common(Reading& reading, const Plan& plan, const Field& field, std::string_view cell);

/// The target of the reading's axis from a cell of the role `target`; what is wrong, or nothing.
[[nodiscard]] std::string set_target(Reading& reading, const Plan& plan, const Field& field, std::string_view cell);

/// "Abweichung [mm]", "Pos (in)", "error_um", "T / °C", "Weg Zoll": the unit between brackets or at the end. Single
/// letters and words that mean other things too count between brackets and behind an underscore only. Nothing where
/// none is stated.
[[nodiscard]] std::optional<Unit> unit_in_heading(std::string_view heading);

}  // namespace ecs::laser
