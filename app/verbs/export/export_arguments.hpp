// The arguments of every verb that writes tables for a controller, and reading what they name.
// Does not live here: what an export begins with (commissioning/maps/export_source.hpp).
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/maps/export_source.hpp"

namespace ecs::app {

/// Adds FILE, --unit, --params, --machine, --model, --other-machine, -o and --force.
void take_export_arguments(Verb& verb, ExportArguments& arguments, const std::string& output_help);

/// Reads the map, from the unit with --unit, and everything it goes with. A `usage` problem for --model without
/// --machine.
[[nodiscard]] Result<ExportWork> read_export_work(VerbContext& context, const ExportArguments& arguments);

}  // namespace ecs::app
