#include "app/screens/unit/status_line.hpp"

#include <fmt/format.h>

#include "core/fault.hpp"

namespace ecs::app {

StatusLine status_line_of(const WatchedUnit& unit, const std::optional<protocol::MonitorSample>& newest) {
  StatusLine status;
  status.link = unit.emulator ? "EMULATOR" : unit.link;
  if (unit.lent) {
    status.state = "busy";
  } else if (!unit.problem.empty()) {
    status.state = "no answer";
    status.bad = true;
  } else if (newest) {
    status.state = ecs::name_of(newest->mode);
    if (newest->fault != Fault::none) {
      status.state += fmt::format(", FAULT {}", ecs::text_of(newest->fault).name);
      status.bad = true;
    }
  } else {
    status.state = unit.open ? "..." : "opening";
  }
  if (status.link.empty()) status.link = "line";
  return status;
}

}  // namespace ecs::app
