// Files of one machine beside readings or a unit of another: said when the file is chosen, not when it is sent.
#pragma once

#include <string>
#include <vector>

#include "commissioning/laser_session/lines.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

/// Why these parameters belong to another machine than the measured lines or the unit; empty: as far as is known they
/// do not. Compared: axes, machine named in the files, configuration of the unit or of its emulated machine.
[[nodiscard]] std::string mismatch_of(const params::ParametersFile& parameters, const std::vector<LaserLine>& lines,
                                      const WatchedUnit& unit);

/// The same of a machine file. @param set  what was measured
[[nodiscard]] std::string mismatch_of(const params::Machine& machine, const laser::MeasurementSet& set,
                                      const WatchedUnit& unit);

}  // namespace ecs::commissioning
