// Screw compensation files of LinuxCNC: three numbers a line, a file for each joint.
// Source: LinuxCNC manual, INI configuration, COMP_FILE and COMP_FILE_TYPE; behaviour measured with LinuxCNC 2.9.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

inline constexpr std::size_t kLinuxCncMostPoints = 256;  ///< of the rest LinuxCNC uses nothing

enum class MachineUnits { mm, inch };

struct LinuxCncOptions {
  int type = 1;  ///< COMP_FILE_TYPE. 0: nominal, where the machine really is forward, reverse; 1: nominal, trims
  MachineUnits units = MachineUnits::mm;          ///< [TRAJ] LINEAR_UNITS
  std::size_t most_points = kLinuxCncMostPoints;  ///< 2 … 256
};

/// `x.comp`, `y.comp`, `z.comp` for the positioning tables of the axes that exist. Numbers and blanks only, nominal
/// strictly increasing: LinuxCNC stops reading without a message at anything else. Refused: no positioning table.
[[nodiscard]] Result<ControllerExport> linuxcnc_export(const ExportSource& source, const LinuxCncOptions& options);

/// Whether the writer names files like that.
[[nodiscard]] bool is_linuxcnc_file(std::string_view name);

struct LinuxCncReadOptions {
  Axis axis = Axis::X;
  std::optional<int> type;  ///< absent: taken from the numbers, with a note; refused where they leave it open
  MachineUnits units = MachineUnits::mm;
  bool as_loaded = false;  ///< only what LinuxCNC itself would take; else every row of three numbers
};

/// Warnings name the lines at which LinuxCNC stops without a word (a comment, an empty line, a mark at the beginning),
/// drops a row (nominal not increasing) or takes no more (after 256). Refused, all at once: rows that are no three
/// numbers, values no machine can need, no rows.
[[nodiscard]] Result<ControllerTables> parse_linuxcnc(std::string_view text, const std::string& file_name,
                                                      const LinuxCncReadOptions& options);

/// What is to be written into the INI file for the joint that moves the axis, each line by itself.
[[nodiscard]] std::vector<std::string> linuxcnc_ini_lines(int joint, const std::string& file_name, int type);

}  // namespace ecs::controllers
