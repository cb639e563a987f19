// The state of a unit in words and as JSON: mode, fault with what to do next, memory tests, pointers, axes.
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "commissioning/unit/status_snapshot.hpp"

namespace ecs::commissioning {

/// "forward", "reverse", "unknown"
[[nodiscard]] std::string_view name_of(Approach approach);

/// All of it; lines of at most 80 columns.
[[nodiscard]] Cell status_cell(const StatusSnapshot& snapshot);
/// What hosts did to the unit, or tried, a line each.
[[nodiscard]] Cell events_cell(const std::vector<protocol::HostEvent>& events);
/// The same as a status file holds it: marked as one, with the registers under "raw".
[[nodiscard]] Json json_with_registers(const StatusSnapshot& snapshot);
// parts of its text
[[nodiscard]] std::string axes_text(const StatusSnapshot& snapshot);        ///< a row for each axis
[[nodiscard]] std::string pointers_text(const StatusSnapshot& snapshot);    ///< a row for each curve in use
[[nodiscard]] std::string memory_text(const protocol::UnitStatus& status);  ///< RAM test, block check, active map

/// The fault in plain words, its place if it has one, and what to do next. @pre fault is not none
[[nodiscard]] std::string fault_sentence(const protocol::UnitStatus& status);

}  // namespace ecs::commissioning
