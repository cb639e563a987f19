// `ecs-emulator hide`. Does not live here: what it hides and writes (files.hpp).
#pragma once

namespace CLI {
class App;
}

namespace ecs::emulator {

/// @param exit_code  set when the verb has run; must live as long as the parsing
void add_hide_verb(CLI::App& app, int& exit_code);

}  // namespace ecs::emulator
