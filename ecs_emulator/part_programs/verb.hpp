// The command line around part programs: options of `run` and `mdi`, and the verb `ecs-emulator program` that writes
// them. Does not live here: what they do (ecs_emulator/workshop/program.hpp, writer.hpp).
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace ecs::emulator {

/// Options of `run` that write themselves into `request`, which must live as long as the parsing.
void add_run_options(CLI::App& verb, nlohmann::json& request);
void add_mdi_options(CLI::App& verb, nlohmann::json& request);

/// @param exit_code  set when the verb has run; must live as long as the parsing
void add_program_verb(CLI::App& app, int& exit_code);

}  // namespace ecs::emulator
