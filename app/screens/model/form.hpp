// Which model, which measurements, which machine: asked before the MODEL screen opens.
#pragma once

#include <memory>

#include "app/ui/screen.hpp"

namespace ecs::app {

[[nodiscard]] std::unique_ptr<Screen> model_form();

}  // namespace ecs::app
