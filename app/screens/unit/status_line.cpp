#include "app/screens/unit/status_line.hpp"

#include <fmt/format.h>

#include "core/fault.hpp"

namespace ecs::app {

Standing standing_of(const WatchedUnit& unit, const std::optional<protocol::MonitorSample>& newest) {
  Standing standing;
  standing.link = unit.emulator ? "EMULATOR" : unit.link;
  if (unit.lent) {
    standing.state = "busy";
  } else if (!unit.problem.empty()) {
    standing.state = "no answer";
    standing.bad = true;
  } else if (newest) {
    standing.state = ecs::name_of(newest->mode);
    if (newest->fault != Fault::none) {
      standing.state += fmt::format(", FAULT {}", ecs::text_of(newest->fault).name);
      standing.bad = true;
    }
  } else {
    standing.state = unit.open ? "..." : "opening";
  }
  if (standing.link.empty()) standing.link = "line";
  return standing;
}

}  // namespace ecs::app
