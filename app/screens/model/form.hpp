// Which model, which measurements, which machine: asked before the MODEL screen opens.
#pragma once

#include <memory>

#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

/// @param unit  to which maps of the model are sent
[[nodiscard]] std::unique_ptr<Screen> model_form(std::shared_ptr<UnitConnection> unit);

}  // namespace ecs::app
