// A map from a file or from the unit, whichever the command line names.
// Does not live here: what is done with it (the verbs), the transfer (commissioning/unit/transfer.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/cli/verb_context.hpp"
#include "base/result.hpp"
#include "commissioning/link/unit_link.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::app {

struct FoundMap {
  laser::ErrorMap map;
  std::optional<UnitParameters> parameters;  ///< of the unit
  std::string name;                          ///< the file, or "the unit"
};

/// The map in the unit, decoded, with its parameters. Refused, saying why, if it holds none or an unsound one.
[[nodiscard]] Result<FoundMap> map_in(protocol::UnitClient& client, const protocol::ProgressCallback& progress = {});
/// The same; the context shows how far it is.
[[nodiscard]] Result<FoundMap> map_in(VerbContext& context, UnitLink& unit);

/// `file`, or the unit's map with `from_unit`. A `usage` problem unless exactly one of the two is asked for.
[[nodiscard]] Result<FoundMap> found_map(VerbContext& context, const std::string& file, bool from_unit);

}  // namespace ecs::app
