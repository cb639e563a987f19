// The requests `run` and `mdi` of the workshop: part programs and single blocks. For .cpp files of this folder only:
// heavy.
#pragma once

#include <functional>
#include <string>

#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {

/// `run`: `program` (file), `axis`, `sense`, `instrument`, `output`, `trace`, `trace_period`, `date`, `engineer`.
/// `mdi`: `block`, one line of the dialect, from G90, G17 and no feed.
[[nodiscard]] Result<nlohmann::json> run_part_program(const Workshop& workshop, Arguments& arguments,
                                                      const std::function<void(const std::string&)>& report);
[[nodiscard]] Result<nlohmann::json> run_block(const Workshop& workshop, Arguments& arguments);

}  // namespace ecs::emulator
