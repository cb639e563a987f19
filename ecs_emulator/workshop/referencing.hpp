// The reference sequence of the machine's own control: what it does on its switch and marker, axis after axis.
// Does not live here: the unit that watches (ecs_emulator/unit/datum_watch.hpp).
#pragma once

#include <vector>

#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {

/// The operator brings each axis in rapid to the approach side of its switch; the control then seeks the switch at
/// reference speed, creeps on or back to the marker as its family does (core/datum.hpp names them), takes that place as
/// its reference and goes to the reference position. An axis ends on `datum_mm`.
/// Problems (refused): given up; an alarm of the control, which leaves the axis where it is: switch not met before the
/// end of travel, switch not left, no marker.
[[nodiscard]] Result<void> reference(Simulation& simulation, const std::vector<Axis>& axes);

}  // namespace ecs::emulator
