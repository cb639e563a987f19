// The logbook that a verb of `ecs log` reads, and other verbs done again from it.
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/logbook/replay.hpp"
#include "commissioning/logbook/store.hpp"

namespace ecs::app {

/// `--log` and `--machine`, as members of a verb's arguments.
struct LogArguments : VerbArguments {
  const std::string& log =
      text("--log", "logbook file (.ecslog); by default the one of --machine, else the one written last");
  const std::string& machine =
      text("--machine", "name or serial number of the machine, or its machine file or parameters");
};

/// Refused where the file is the logbook of another machine than --machine.
[[nodiscard]] Result<Logbook> chosen_logbook(VerbContext& context, const LogArguments& arguments);

/// Runs a verb of this program with --json and answers what it says on stdout.
[[nodiscard]] RunVerb run_again();

}  // namespace ecs::app
