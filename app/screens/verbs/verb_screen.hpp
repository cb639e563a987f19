// A verb as a form: its options as fields with their help, Enter runs it, the answer scrolls below.
#pragma once

#include <memory>

#include "app/cli/catalogue.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

/// The connection's link is filled in where the verb takes one; the connection lends the link while it runs.
[[nodiscard]] std::unique_ptr<Screen> verb_screen(VerbEntry verb, std::shared_ptr<UnitConnection> connection);

}  // namespace ecs::app
