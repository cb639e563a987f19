// The screens of the menu ECS UTILITY, as thesis figure 5.4 names them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/ui/menu_screen.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/unit/datum_recording.hpp"

namespace ecs::app {

[[nodiscard]] std::unique_ptr<Screen> position_screen(std::shared_ptr<UnitConnection> connection);
[[nodiscard]] std::unique_ptr<Screen> output_screen(std::shared_ptr<UnitConnection> connection);
[[nodiscard]] std::unique_ptr<Screen> datum_record_screen(std::shared_ptr<UnitConnection> connection);
/// @param recording  that was just made; nothing: none yet  @param file  of one to open; empty: none
[[nodiscard]] std::unique_ptr<Screen> datum_view_screen(std::optional<DatumRecording> recording = std::nullopt,
                                                        const std::string& file = {});
[[nodiscard]] std::unique_ptr<Screen> datum_test_screen(std::shared_ptr<UnitConnection> connection);
/// @param file  saved state of a unit, or a dump, that is shown first; empty: the unit
[[nodiscard]] std::unique_ptr<Screen> status_screen(std::shared_ptr<UnitConnection> connection,
                                                    const std::string& file = {});

[[nodiscard]] std::unique_ptr<Screen> tools_screen(std::shared_ptr<UnitConnection> connection);

[[nodiscard]] std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitConnection>& connection);

}  // namespace ecs::app
