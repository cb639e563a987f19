#include "commissioning/unit/tools.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/csv_table.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::array<std::string_view, 4> kToolColumns{"number", "x_mm", "y_mm", "z_mm"};
constexpr double kFurthest_mm = 10'000.0;

std::vector<Tool> tools_of(const ToolTable& table) {
  std::vector<Tool> tools;
  for (const Tool& tool : table.tools)
    if (tool.number != 0) tools.push_back(tool);
  std::ranges::sort(tools, {}, &Tool::number);
  return tools;
}

/// What is wrong with a table of which a copy is damaged; empty: none is.
std::string damage_text(std::size_t damaged_copies) {
  if (damaged_copies == 0) return {};
  return damaged_copies == 1 ? "one of the two copies of the table of tools is damaged, and this one may be the older: "
                               "check it, then select the tool or send the table again"
                             : "the table of tools was damaged: select the tool or send the table again";
}

/// Why the unit would refuse one of them, found out before anything is sent.
Result<void> check_tools(const std::string& file, const std::vector<Tool>& tools, const ToolTable& before,
                         const UnitParameters& parameters) {
  const Vector3& range_mm = parameters.tool_range_mm;
  for (const Tool& tool : tools)
    if (!in_range(tool.offset_mm, parameters))
      return problem(ProblemKind::refused,
                     "{}: tool {} is beyond the tool range of the unit's parameters, X {:.10g}, Y {:.10g}, Z "
                     "{:.10g} mm (compensation.tool_range_mm). The table in the unit is unchanged",
                     file, tool.number, range_mm[0], range_mm[1], range_mm[2]);
  if (before.selected != 0 && std::ranges::find(tools, before.selected, &Tool::number) == tools.end())
    return problem(ProblemKind::refused,
                   "{}: tool {} is selected, and is not in the file; select another "
                   "one first. The table in the unit is unchanged",
                   file, before.selected);
  return {};
}

}  // namespace

Result<ToolsInUnit> tools_in_unit(protocol::UnitClient& client) {
  ECS_TRY(lines, client.control_lines());
  ECS_TRY(record, client.tool_record());
  return ToolsInUnit{lines, tools_of(record.table), record.damaged_slots};
}

std::string acting_text(const ToolsInUnit& unit) {
  const protocol::ControlLines& lines = unit.lines;
  std::string text =
      lines.tool == 0 ? "no tool is selected from the tool table" : fmt::format("tool {} is selected", lines.tool);
  if (lines.tool_state == protocol::ToolState::unknown)
    text += ", but " + (unit.damaged_copies > 0 ? damage_text(unit.damaged_copies)
                                                : "it is not in the table, or is beyond compensation.tool_range_mm");
  if (!lines.compensating_out) return text + " (compensation is off)";
  return text + fmt::format("; acting offset X {:.4f}, Y {:.4f}, Z {:.4f} mm{}", lines.tool_offset_mm[0],
                            lines.tool_offset_mm[1], lines.tool_offset_mm[2],
                            lines.tool_state == protocol::ToolState::changing ? ", still changing" : "");
}

std::string_view state_text(const protocol::ControlLines& lines) {
  const bool selected = lines.tool_state == protocol::ToolState::acting && !lines.compensating_out;
  return selected ? "selected" : name_of(lines.tool_state);
}

Result<std::vector<Tool>> read_tools(const std::string& file) {
  ECS_TRY(text, read_file(file));
  laser::Findings findings(file);
  ECS_TRY(table, laser::parse_csv_table(text, file, kToolColumns, findings));
  laser::TableReader reader(table, findings);
  std::vector<Tool> tools;
  std::set<double> seen;
  for (const laser::CsvRow& row : table.rows) {
    reader.take(row);
    const auto number = reader.number("number");
    const auto x = reader.number("x_mm", kFurthest_mm), y = reader.number("y_mm", kFurthest_mm),
               z = reader.number("z_mm", kFurthest_mm);
    if (!number || !x || !y || !z) continue;
    if (!(*number >= 1.0 && *number <= kGreatestToolNumber && *number == std::floor(*number)))
      reader.wrong("number", fmt::format("a whole number from 1 to {}", kGreatestToolNumber));
    else if (!seen.insert(*number).second)
      reader.wrong("number", "each tool once");
    else
      tools.push_back({static_cast<std::uint16_t>(*number), protocol::in_tool_steps({*x, *y, *z})});
  }
  if (tools.empty() && findings.empty())
    findings.add(0, 0, "expected at least one tool; `ecs utility tool N --remove` removes one");
  if (tools.size() > kMostTools) findings.add(0, 0, "expected at most {} tools, found {}", kMostTools, tools.size());
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return tools;
}

Result<SentTools> send_tools(protocol::UnitClient& client, const std::string& file, const std::vector<Tool>& tools) {
  ECS_TRY(before, client.tool_record());
  ECS_TRY(parameters, receive_parameters(client));
  ECS_DO(check_tools(file, tools, before.table, parameters));
  const auto is_held = [&](const Tool& tool) {
    const Tool* const held = tool_of(before.table, tool.number);
    return held != nullptr && protocol::in_tool_steps(held->offset_mm) == tool.offset_mm;
  };
  SentTools sent{tools.size(), static_cast<std::size_t>(std::ranges::count_if(tools, std::not_fn(is_held))), 0};
  for (const Tool& tool : tools_of(before.table))
    sent.removed += std::ranges::find(tools, tool.number, &Tool::number) == tools.end() ? 1U : 0U;
  if (sent.set + sent.removed + before.damaged_slots > 0) ECS_DO(client.replace_tools(tools));
  return sent;
}

}  // namespace ecs::commissioning
