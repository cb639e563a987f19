// What can be made to go wrong in the workshop, by name: in the unit, on the machine's wires, on the line.
// Does not live here: what the unit makes of it (ecs_emulator/unit/unit.hpp, docs/unit.md).
#pragma once

#include "base/result.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {

class Arguments;

/// Provokes the fault that the argument `name` names, or mends everything (`clear`); docs/emulator.md lists them.
[[nodiscard]] Result<void> provoke(const Workshop& workshop, Arguments& arguments);

}  // namespace ecs::emulator
