// The table of tools in a unit, as the verbs and the screen of tools share it: read, in words, out of a file, replaced.
// Does not live here: what the unit does with a tool (docs/unit.md).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/tools.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct ToolsInUnit {
  protocol::ControlLines lines;
  std::vector<Tool> tools;  ///< by number
  std::size_t damaged_copies =
      0;  ///< of the two copies of the table: with one it may be an older table, with both none
};
[[nodiscard]] Result<ToolsInUnit> tools_in_unit(protocol::UnitClient& client);

/// Which tool is selected and acts, or why it is not known.
[[nodiscard]] std::string acting_text(const ToolsInUnit& unit);
/// "selected" for a tool that would act if the unit compensated, else the state of the tool.
[[nodiscard]] std::string_view state_text(const protocol::ControlLines& lines);

/// A table of the columns number, x_mm, y_mm, z_mm; offsets as the unit takes them.
[[nodiscard]] Result<std::vector<Tool>> read_tools(const std::string& file);

struct SentTools {
  std::size_t tools = 0, set = 0, removed = 0;
};
/// Replaces the whole table; nothing is sent where nothing differs and no copy is damaged.
/// @param file  where the tools came from, for problems
[[nodiscard]] Result<SentTools> send_tools(protocol::UnitClient& client, const std::string& file,
                                           const std::vector<Tool>& tools);

}  // namespace ecs::commissioning
