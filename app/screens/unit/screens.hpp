// The screens that look at the unit and at what the program did; the counts of the link in plain words.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

[[nodiscard]] std::unique_ptr<Screen> monitor_screen(std::shared_ptr<UnitConnection> connection);
[[nodiscard]] std::unique_ptr<Screen> link_screen(std::shared_ptr<UnitConnection> connection);
[[nodiscard]] std::unique_ptr<Screen> log_screen();
[[nodiscard]] std::unique_ptr<Screen> commands_screen();

struct StatisticsRow {
  std::string name;
  std::string value;
  std::string meaning;  ///< what it says about the link
  Tone tone = Tone::plain;
};
[[nodiscard]] std::vector<StatisticsRow> statistics_rows(const WatchedUnit& unit);
/// The link in one sentence, with what to do where it is not good.
[[nodiscard]] StatisticsRow judgement(const WatchedUnit& unit);

}  // namespace ecs::app
