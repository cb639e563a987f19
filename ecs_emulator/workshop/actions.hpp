// The larger actions of the workshop: faults by name, `measure`, `plan` and `capture`, `run` and `mdi`. For .cpp files
// of this folder only: heavy. Does not live here: the other actions (workshop.cpp), what the unit makes of a fault
// (ecs_emulator/unit/unit.hpp, docs/unit.md).
#pragma once

#include <functional>
#include <string>

#include "base/result.hpp"
#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {

/// The values of the axes that the machine has, by their letters.
[[nodiscard]] nlohmann::json by_axis(const MachineTool& machine, const Vector3& values);

/// Provokes the fault that the argument `name` names, or mends everything (`clear`); docs/emulator.md lists them.
[[nodiscard]] Result<void> provoke(const Workshop& workshop, Arguments& arguments);

/// The readings go into the files under `output`, or back as `csv` where there is none.
[[nodiscard]] Result<nlohmann::json> measure_machine(const Workshop& workshop, Arguments& arguments,
                                                     const std::function<void(const std::string&)>& report);
/// Every row of a `plan` for a `phase`, each into `folder`; nothing is measured where a file would be overwritten.
[[nodiscard]] Result<nlohmann::json> follow_plan(const Workshop& workshop, Arguments& arguments,
                                                 const std::function<void(const std::string&)>& report);
[[nodiscard]] Result<nlohmann::json> capture_machine(const Workshop& workshop, Arguments& arguments);

/// `run`: `program` (file), `axis`, `sense`, `instrument`, `output`, `trace`, `trace_period`, `date`, `engineer`.
/// `mdi`: `block`, one line of the dialect, from G90, G17 and no feed.
[[nodiscard]] Result<nlohmann::json> run_part_program(const Workshop& workshop, Arguments& arguments,
                                                      const std::function<void(const std::string&)>& report);
[[nodiscard]] Result<nlohmann::json> run_block(const Workshop& workshop, Arguments& arguments);

}  // namespace ecs::emulator
