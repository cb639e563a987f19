// The requests `measure`, `plan` and `capture` of the workshop. For .cpp files of this folder only: heavy.
// Does not live here: their arguments (ecs_emulator/instruments/measurement_request.hpp), the other requests
// (workshop.cpp).
#pragma once

#include <functional>
#include <string>

#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {

/// The readings go into the files under `output`, or back as `csv` where there is none.
[[nodiscard]] Result<nlohmann::json> measure_machine(const Workshop& workshop, Arguments& arguments,
                                                     const std::function<void(const std::string&)>& report);
/// Every row of a `plan` for a `phase`, each into `folder`; nothing is measured where a file would be overwritten.
[[nodiscard]] Result<nlohmann::json> follow_plan(const Workshop& workshop, Arguments& arguments,
                                                 const std::function<void(const std::string&)>& report);
[[nodiscard]] Result<nlohmann::json> capture_machine(const Workshop& workshop, Arguments& arguments);

}  // namespace ecs::emulator
