// The CNC's own reference sequence, by controller family (docs/unit.md, "datum kinds").
// Does not live here: how the unit follows it (core/datum.hpp).
#pragma once

#include "ecs_emulator/simulation.hpp"

namespace ecs::emulator {

/// References the given axes one after the other: clear of the switch, onto it, to the marker, to the reference
/// position. False: given up.
[[nodiscard]] bool reference(Simulation& simulation, const std::vector<Axis>& axes);

}  // namespace ecs::emulator
