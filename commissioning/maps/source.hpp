// The map in the unit, with its parameters.
#pragma once

#include <optional>
#include <string>

#include "base/result.hpp"
#include "laser/map/error_map.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct FoundMap {
  laser::ErrorMap map;
  std::optional<UnitParameters> parameters;  ///< of the unit
  std::string name;                          ///< the file, or "the unit"
};

/// The map in the unit, decoded, with its parameters. Refused, saying why, if it holds none or an unsound one.
[[nodiscard]] Result<FoundMap> map_in(protocol::UnitClient& client, const protocol::ProgressCallback& progress = {});
}  // namespace ecs::commissioning
