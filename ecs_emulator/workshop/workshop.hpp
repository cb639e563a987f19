// What a person in the workshop can do, as requests and answers of one JSON object each (docs/emulator.md lists them).
// Does not live here: the socket they come through (serve.hpp), the command line (ecs_emulator/verbs).
#pragma once

#include <functional>
#include <string>

#include "ecs_emulator/machine/simulation.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "protocol/line/faults.hpp"

namespace ecs::emulator {

/// Everything in the workshop that a person can touch. Nothing is owned.
struct Workshop {
  Simulation* simulation = nullptr;
  Unit* unit = nullptr;                  ///< null: there is no unit
  protocol::LinkFaults* line = nullptr;  ///< null: no line
  std::string link{};                    ///< as the host's --link takes it; empty: no line
};

/// Carries out one request, `{"action": "jog", …}`.
/// @param report  progress of long actions, one JSON object a line: {"progress": 0.25}
/// @return one line: {"ok": true, …}, or {"ok": false, "exit": n, "error": {"message": …}}; n as in docs/design.md
[[nodiscard]] std::string perform(const Workshop& workshop, const std::string& request,
                                  const std::function<void(const std::string&)>& report = {});

}  // namespace ecs::emulator
