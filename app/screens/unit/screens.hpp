// The screens that look at the unit and at what the program did.
#pragma once

#include <memory>

#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

[[nodiscard]] std::unique_ptr<Screen> monitor_screen(std::shared_ptr<UnitConnection> connection);
[[nodiscard]] std::unique_ptr<Screen> link_screen(std::shared_ptr<UnitConnection> connection);
[[nodiscard]] std::unique_ptr<Screen> log_screen();
[[nodiscard]] std::unique_ptr<Screen> commands_screen();
[[nodiscard]] std::unique_ptr<Screen> logbook_screen();

}  // namespace ecs::app
