// `ecs-emulator rig`. Does not live here: what it draws (figures.hpp).
#pragma once

namespace CLI {
class App;
}

namespace ecs::emulator {

/// @param exit_code  set when the verb has run; must live as long as the parsing
void add_rig_verb(CLI::App& app, int& exit_code);

}  // namespace ecs::emulator
