// Logbook answers as text and JSON: what the verbs print and the screen shows. Only for .cpp files (heavy header).
#pragma once

#include <string>

#include "base/answer_table.hpp"
#include "modules/logbook/compare.hpp"
#include "modules/logbook/replay.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {

[[nodiscard]] std::string log_list_head();
/// A line of the list; in JSON {"number", "time", "kind", "hash", "previous", "operator", "summary", …}.
[[nodiscard]] Cell log_entry_cell(const LogbookEntry& entry);
/// Everything of one entry.
[[nodiscard]] Cell whole_entry_cell(const LogbookEntry& entry);
[[nodiscard]] Cell verdict_cell(const LogVerdict& verdict, const std::string& path);
[[nodiscard]] Cell replay_cell(const Replay& replay);
[[nodiscard]] Cell comparison_of_log_cell(const LogComparison& comparison);

}  // namespace ecs::commissioning
