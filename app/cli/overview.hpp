// The answer of `ecs` alone: every verb with its help, and the link that would be used.
#pragma once

#include <string>

#include "app/cli/verb.hpp"

namespace ecs::app {

/// The tree of menus with one line per verb, and which link would be used. Opens nothing.
[[nodiscard]] Result<Outcome> overview(const VerbRegistry& registry, VerbContext& context);

/// The tree alone: its menus with one line per verb.
[[nodiscard]] std::string verbs_overview(const VerbRegistry& registry);

}  // namespace ecs::app
