// SINUMERIK 840D: encoder error tables ($AA_ENC_COMP) and sag error tables ($AN_CEC), as files that the control reads.
// Source: Siemens Function Manual Extended Functions, K3 Compensations (6FC5397-1BP40): MSEC, CEC.
//
// Signs. K3: the value is added to the actual position, "a positive compensation value causes the axis to move in the
// negative direction". So a table holds the error = actual − target in mm, which is minus the compensation of a map.
// K3 does not print the sign of CEC; it is taken to be the same, and `cec_adds` writes the other.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

struct SiemensOptions {
  PerAxis<std::string> axis_name{"AX1", "AX2", "AX3"};  ///< machine axes, as the control numbers or names them
  int encoder = 0;                                      ///< 0 or 1: first or second measuring system
  bool cec_adds = false;                                ///< the control adds CEC values instead of subtracting them
  std::size_t most_points = 1000;                       ///< of one table; at most MD38000 and MD18342 (828D: 200)
  std::size_t most_tables = 62;                         ///< CEC tables (828D: 8)
};

/// `AX_EEC.INI` with the mean positioning error of each axis, and `NC_CEC.INI` with two one-direction tables for the
/// reversal of each axis, straightness and squareness. Every table has an even grid and is zero at the reference
/// position of its input axis, but for the reversal, which cannot be. Where there are more tables than the control
/// has: squareness goes into the straightness tables, two directions are kept where they bring most, and if even the
/// means are too many the smallest stay behind; the answer says so.
[[nodiscard]] Result<ControllerExport> siemens_export(const ExportSource& source, const SiemensOptions& options);

/// Whether the writer names files like that.
[[nodiscard]] bool is_siemens_file(std::string_view name);

/// Reads either kind of file, also of a whole-control backup: `N10` numbers, `%_N_…`, `CHANDATA`, M0, M02, M17, M30,
/// RET, machine data, comments; blanks instead of `=`; `[0.1]` instead of `[0,1]`; EX exponents; any case. Left out
/// with a note: tables without points, tables of rotary axes and modulo tables that are all zero. Refused, all at once:
/// lines that are none of these, tables without MIN, MAX or STEP, missing points, multiplied tables, axes that
/// `axis_name` does not tell (AX1 … AX3, X1 … Z1, X … Z are known besides).
[[nodiscard]] Result<ControllerTables> parse_siemens(std::string_view text, const std::string& file_name,
                                                     const SiemensOptions& options);

}  // namespace ecs::controllers
