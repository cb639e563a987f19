// The screens of the menu ECS UTILITY, as thesis figure 5.4 names them.
#pragma once

#include <memory>
#include <vector>

#include "app/ui/menu_screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

[[nodiscard]] std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitConnection>& connection);

}  // namespace ecs::app
