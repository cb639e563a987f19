// What stands between a map and a unit: findings, squareness left behind, another machine, too little memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/map/error_map.hpp"
#include "params/parameters_toml.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// What to do about a file that is for another machine.
inline constexpr std::string_view kTakeTheRightOne =
    "take the right file; if this is meant, map send, params send, memory load and export take it with --other-machine";

/// Every objection of findings_for(), and each squareness that the map's header says was measured while the parameters
/// hold 0 (the value lives in the parameters: `map build --params-out` writes it there).
[[nodiscard]] std::vector<std::string> objections_to_map(const laser::ErrorMap& map, const UnitParameters& parameters);

/// Why the map is not for the machine of these parameters: its header and [identity] both name a machine, or both a
/// serial number, and the names differ. What one side does not state is not judged.
[[nodiscard]] std::vector<std::string> other_machine(const laser::MapHeader& header, const params::Identity& identity);

/// The same, worded for somebody who only makes the two files: that they will not be sent together.
[[nodiscard]] std::vector<std::string> made_for_two_machines(const laser::MapHeader& header,
                                                             const params::Identity& identity);

/// The same against the serial number that the unit reports, for a map and for parameters.
[[nodiscard]] std::vector<std::string> other_unit(const laser::MapHeader& header, const std::string& serial_number);
[[nodiscard]] std::vector<std::string> other_unit(const params::Identity& identity, const std::string& serial_number);

/// The same for a dump: the serial number of the unit that it was taken from, and that of the map in its image. A
/// header that cannot be read is an objection too.
/// @param image  sound, of the dump
[[nodiscard]] std::vector<std::string> other_unit(const std::string& dumped_from, std::span<const std::uint8_t> image,
                                                  const std::string& serial_number);

/// Why an image does not fit into a unit: its parameters want more axis memory modules than the unit has, or it holds
/// more values or bytes than they hold. @param image  sound
[[nodiscard]] std::vector<std::string> no_room_for(std::span<const std::uint8_t> image,
                                                   const protocol::Identity& identity);

/// As one `refused` problem about `file` (empty: none); nothing for no objection.
[[nodiscard]] std::optional<Problem> refused_map(const std::vector<std::string>& objections, const std::string& file);

}  // namespace ecs::commissioning
