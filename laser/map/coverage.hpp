// How far the tables of a map reach: against each other and against the travels of the machine.
// Does not live here: what a map must hold (error_map.hpp), where the travels come from (a machine file).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "laser/map/error_map.hpp"

namespace ecs::laser {

/// Lower and upper end of each axis's travel, machine coordinates [mm]; absent: not known.
using Travels = PerAxis<std::optional<std::array<double, 2>>>;

/// findings_for() with the travels of the machine. It warns (no objection) where
/// - a component covers less than its axis's travel by more than one spacing of its points, or 5 % of the travel, at an
///   end; where no travel is known, what all tables of the axis cover together stands for it,
/// - forward and reverse end a spacing apart (more than that is an objection already),
/// - a table has two points only.
/// Tables that the parameters do not use are not judged.
[[nodiscard]] std::vector<MapFinding> findings_for(const ErrorMap& map, const UnitParameters& parameters,
                                                   const Travels& travels);

/// The warnings above alone.
[[nodiscard]] std::vector<MapFinding> coverage_warnings(const ErrorMap& map, const UnitParameters& parameters,
                                                        const Travels& travels);

/// Fields that a header should state and does not, in words: "customer", "machine", "serial number", "engineer",
/// "date".
[[nodiscard]] std::vector<std::string> missing_in(const MapHeader& header);

}  // namespace ecs::laser
