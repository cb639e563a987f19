// A map with the parameters it goes with, judged and turned into the bytes for the unit, without a unit.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/error_map.hpp"
#include "laser/map/image.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

struct PreparedMap {
  laser::MapHeader header;
  params::Identity identity;  ///< of the parameters
  laser::MapImage image;
  std::vector<std::string> remarks;  ///< findings worth knowing that are no objections; defaults taken
};

struct PrepareOptions {
  bool other_machine = false;                  ///< also a map whose header names another machine
  Incomplete incomplete = Incomplete::refuse;  ///< parameters without their closing line
  bool accept_resampling = false;              ///< also where it changes a table by more than its resolution
};

/// Reads both files; refuses, with every reason, parameters that must not meet a machine, a map that is incomplete for
/// them, one whose header names another machine, or one that resampling changes.
[[nodiscard]] Result<PreparedMap> prepared_map(const std::string& map_file, const std::string& params_file,
                                               const PrepareOptions& options = {});

/// Why the unit with this serial number is not the one of the map, or not the one of its parameters.
[[nodiscard]] std::vector<std::string> other_unit(const PreparedMap& map, const std::string& serial_number);

}  // namespace ecs::commissioning
