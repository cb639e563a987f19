// Files of one machine beside readings or a unit of another: said when the file is chosen, not when it is sent.
#pragma once

#include <string>
#include <vector>

#include "commissioning/laser_session/lines.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

/// Why these parameters belong to another machine than the measured lines; empty: as far as is known they do not.
/// Compared: axes, machine named in the files.
[[nodiscard]] std::string mismatch_of(const params::ParametersFile& parameters, const std::vector<LaserLine>& lines);
/// Why the unit, or its emulated machine, would refuse what is made with these parameters.
[[nodiscard]] std::string other_unit_for(const UnitParameters& parameters, const WatchedUnit& unit);

/// The same of a machine file. @param set  what was measured
[[nodiscard]] std::string mismatch_of(const params::Machine& machine, const laser::MeasurementSet& set);
[[nodiscard]] std::string other_unit_for(const params::Machine& machine, const WatchedUnit& unit);

}  // namespace ecs::commissioning
