// What `ecs` alone says: what it can do, and how the link stands.
#pragma once

#include "app/cli/verb_context.hpp"
#include "base/outcome.hpp"

namespace CLI {
class App;
}

namespace ecs::app {

/// The tree of menus with one line per verb, and which link would be used. Opens nothing.
[[nodiscard]] Result<Outcome> overview(const CLI::App& root, VerbContext& context);

}  // namespace ecs::app
