// What stands between a map and a unit: findings, squareness left behind, a map of another machine.
// Does not live here: findings of map and parameters alone (laser/error_map.hpp), sending (transfer.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/error_map.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {

/// Every objection of findings_for(), and each squareness that the map's header says was measured while the parameters
/// hold 0 (the value lives in the parameters: `map build --params-out` writes it there).
[[nodiscard]] std::vector<std::string> objections_to_map(const laser::ErrorMap& map, const UnitParameters& parameters);

/// Why the map is not for the machine of these parameters: its header and [identity] both name a machine, or both a
/// serial number, and the names differ. What one side does not state is not judged.
[[nodiscard]] std::vector<std::string> other_machine(const laser::MapHeader& header, const params::Identity& identity);

/// The same against the serial number that the unit reports.
[[nodiscard]] std::vector<std::string> other_unit(const laser::MapHeader& header, const std::string& serial_number);

/// As one `refused` problem about `file`; nothing for no objection.
[[nodiscard]] std::optional<Problem> refused_map(const std::vector<std::string>& objections, const std::string& file);

}  // namespace ecs::app
