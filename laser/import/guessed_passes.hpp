// Columns of a table that nobody has described that belong together: passes and runs, and senses along one axis.
// Internal to the suggestion of options. Does not live here: what a single column holds (guessed_columns.hpp).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "laser/import/guessed_columns.hpp"

namespace ecs::laser {

/// The letter of a linear or of a rotary axis in a heading, lower case; else `otherwise`.
[[nodiscard]] char axis_letter(const TableColumn& column, std::string_view letters, char otherwise);
/// Errors without a unit are um, but mm where they would all be far too small for um.
[[nodiscard]] std::string error_unit(const TableColumn& column, double largest);
[[nodiscard]] double largest_of(const TableColumn& column);
/// "2[um]" of a column of readings.
/// @param largest  of all columns that have the same unit
[[nodiscard]] std::string reading_place(const TableColumn& column, const TableColumn& targets, bool actual,
                                        double largest);

/// Direction of an error across, or about, the moving axis.
struct StatedSense {
  std::string name{};     ///< "EY"; empty: along the axis, as far as the heading says
  std::string assumed{};  ///< a sentence
};
/// @param axis     letter of the moving axis, lower case
/// @param is_sure  the table names that axis
/// @param used     names of the senses that other columns have
[[nodiscard]] StatedSense sense_of(const TableColumn& column, char axis, bool is_sure, std::string_view used);

/// The columns of passes and what is assumed of them; no rules: there are none.
struct PassColumns {
  std::string rules{};
  std::string assumed{};
  bool numbered = false;   ///< the columns name the runs
  bool by_motion = false;  ///< they do not name the approach
};
/// "forward1=2[um],reverse1=3[um]" where the columns of errors are passes or runs, each another.
/// @param readings  one of them
/// @param like      a column is of the same sense
[[nodiscard]] PassColumns pass_columns(const Columns& columns, const TableColumn& targets, const TableColumn& readings,
                                       bool actual, const std::function<bool(const TableColumn&)>& like);

/// The sense of a column beside those that are used.
using SenseBy = std::function<StatedSense(const TableColumn&, std::string_view used)>;
/// Columns of several senses along one axis, "EX=3[um],EZ=4[um]"; empty: the headings state no other sense.
[[nodiscard]] std::string sense_columns(const Columns& columns, const TableColumn& targets, const TableColumn& readings,
                                        char axis, const SenseBy& sense_by, std::vector<std::string>& assumed);

}  // namespace ecs::laser
