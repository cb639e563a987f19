// The plan of `ecs batch`: which units get which parameters and map over which link.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::commissioning {

/// One `[[unit]]`. Paths are complete.
struct PlannedUnit {
  std::string name;
  LinkChoice link;
  std::string serial_number;  ///< that the unit must report; empty: not checked
  std::string params;
  std::string map;  ///< empty: parameters alone, the unit's map stays
};

/// Every wrong unit at once. `link` and `params` are needed: a batch has no default link. Files and the machine of an
/// `emulator:` link count from the folder of the plan.
[[nodiscard]] Result<std::vector<PlannedUnit>> parse_batch_plan(std::string_view text, const std::string& name,
                                                                const std::filesystem::path& folder);
/// Of a table (.csv) with the columns id, link, params, and serial_number, map, arm_code if any: a unit a line, as the
/// machines of a fleet (commissioning/manifest); else of TOML.
[[nodiscard]] Result<std::vector<PlannedUnit>> read_batch_plan(const std::filesystem::path& path);

}  // namespace ecs::commissioning
