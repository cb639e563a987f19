// The rotary axes of a map: from their errors in a file (`--rotary`) and the machine file. Does not live here: how the
// map and its image hold them (laser/map/rotary_map.hpp), where the errors come from (volume/rotary_errors.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "laser/map/error_map.hpp"
#include "params/machine.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::commissioning {

/// Every rotary axis of the machine, its curves as compensation every 10 deg, or closer where their points need it: the
/// widest increment of the unit on which they all are, else 0.5 deg, which `notes` states with the largest change.
/// Refused: a machine without rotary axes, one whose unit has no input for an angle.
[[nodiscard]] Result<std::vector<laser::MapRotaryAxis>> rotary_part_of(const volume::RotaryErrors& errors,
                                                                       const params::RotaryMachine& machine,
                                                                       std::vector<std::string>& notes);

/// The same of the files into the header of a map, with a line of its processing. No file of errors: nothing is done.
[[nodiscard]] Result<void> add_rotary(laser::MapHeader& header, const std::string& rotary_file,
                                      const std::string& machine_file, std::vector<std::string>& notes);

/// The rotary axes of a map: location errors, increment, and the largest compensation of each curve; as text bending
/// too. No text where there are none.
[[nodiscard]] Cell rotary_cell(const laser::MapHeader& header);
/// Sizes of bending as a map file has them, as text by their names those that are not zero.
[[nodiscard]] Cell bending_cell(const RotaryBending& bending);

}  // namespace ecs::commissioning
