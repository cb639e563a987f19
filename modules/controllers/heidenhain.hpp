// HEIDENHAIN: compensation-value tables (.COM) of each axis and their list (.CMA), with the columns C1 to C6 of
// KinematicsComp or without. Sources: MANUALplus 620 Technical Manual p. 716, 718 (.COM, .CMA); iTNC 530 HSCI Technical
// Manual p. 680 (which error in which column), 684 (entries of the kinematics table), 686 (limits).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

struct HeidenhainOptions {
  bool kinematics = true;         ///< straightness and rotations in C1 to C6; false: axis columns only, no rotations
  bool holds_errors = true;       ///< the control takes the values off; false: it adds them
  bool levers_from_zero = true;   ///< as EtalonOptions
  std::size_t most_points = 256;  ///< of one table
  std::optional<Axis> axis;       ///< reading: the axis of the table; by its name where absent
};

/// A table for each axis and config.cma. Positioning is in the column of the axis, the reverse approach in BACKLASH;
/// straightness and rotations are the mean of both. Squareness is a slope of straightness. Refused: printed signs, a
/// map without anything for an axis of the machine.
[[nodiscard]] Result<ControllerExport> heidenhain_export(const ExportSource& source, const HeidenhainOptions& options);

/// `BEGIN NAME.COM MM`, the heading, rows with an AXISPOS, `[END]`; cells stand under their heading. A .CMA has no
/// tables of its own: a note. Refused: inches, tables with even steps (DATUM, DISTANCE), positions that do not rise,
/// cells that are no number, a BACKLASH without a value of the axis.
[[nodiscard]] Result<ControllerTables> parse_heidenhain(std::string_view text, const std::string& file_name,
                                                        const HeidenhainOptions& options);

/// What stands in column C1 … C6 of the table of an axis: EX, EY, EZ, EA, EB, EC of its motion.
inline constexpr std::size_t kHeidenhainColumns = 6;

/// Digits behind the point, mm and degrees.
inline constexpr int kHeidenhainLengthDigits = 4, kHeidenhainAngleDigits = 6;

}  // namespace ecs::controllers
