// The logbook that a verb of `ecs log` reads, and other verbs done again from it.
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "modules/logbook/replay.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::app {

/// Which logbook a verb reads.
struct LogChoice {
  std::string log, machine;
  static Fields<LogChoice> fields() {
    using C = LogChoice;
    return {{"--log", &C::log, "logbook file (.ecslog); by default the one of --machine, else the one written last"},
            {"--machine", &C::machine, "name or serial number of the machine, or its machine file or parameters"}};
  }
};

/// Refused where the file is the logbook of another machine than --machine.
[[nodiscard]] Result<Logbook> chosen_logbook(VerbContext& context, const LogChoice& choice);

/// Runs a verb of this program with --json and answers what it says on stdout.
[[nodiscard]] RunVerb run_again();

}  // namespace ecs::app
