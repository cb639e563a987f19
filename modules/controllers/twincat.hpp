// Leadscrew error compensation of TwinCAT CNC and ISG kernels (SSFK, LSEC): one compensation value list for each axis.
// Source: Beckhoff TF5200, "Axis compensation" and "Axis compensation parameters" (P-COMP-00001 … 00059),
// https://infosys.beckhoff.com/content/1033/tf5200_axis_compensation/308695435.html
//
// Signs. The page above computes the value as actual minus nominal, "absolute position errors": programmed
// 19866.7 um, measured 19856.5 um in the positive and 19874.7 um in the negative direction, pos −102, neg 80 (in 0.1
// um). So a list holds the error, which is minus the compensation of a map; `adds` writes and reads the other sign.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

/// kw_nr_max must stay below kw.ssfk.max_points, 1500 unless it is set.
inline constexpr std::size_t kTwinCatMostPoints = 1499;

struct TwinCatOptions {
  PerAxis<int> axis_number{1, 2, 3};             ///< logical axis numbers of the control, above 0, all different
  std::size_t most_points = kTwinCatMostPoints;  ///< 2 … 1499
  /// The control adds the values instead of subtracting them. Absent: a list of ours is read as it says; else no.
  std::optional<bool> adds;
};

/// `achskw1.lis` and so on, named after the logical axis numbers, for the positioning tables of the axes that exist:
/// a table for each direction, positions and errors as whole tenths of a micrometre. Notes name the step of each axis
/// when its list becomes active at the reference position, and values that TwinCAT 2 has no room for. Refused: no
/// positioning table.
[[nodiscard]] Result<ControllerExport> twincat_export(const ExportSource& source, const TwinCatOptions& options);
/// Whether the writer names files like that: "achskw12.lis".
[[nodiscard]] bool is_twincat_file(std::string_view name);

/// Reads `kopf.*` and `kw.ssfk.*`: points of their own or at even steps, one table or two; any case; comments behind
/// `#` or behind the value. Left out with a note: other compensations of the same list. Refused, all at once: lines
/// that are none of these, encoder increments, modulo axes, points that are missing or do not rise, values no machine
/// can need, a list whose axis cannot be told or is none of X, Y, Z by its name, a list of ours with the other sign
/// than `options` ask for.
/// @param axis  given: whatever the list says
[[nodiscard]] Result<ControllerTables> parse_twincat(std::string_view text, const std::string& file_name,
                                                     const TwinCatOptions& options,
                                                     std::optional<Axis> axis = std::nullopt);

}  // namespace ecs::controllers
