// The counts of a link in plain words: how many, and whether that is a cause for concern.
#pragma once

#include <string>
#include <vector>

#include "app/ui/cells.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

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
