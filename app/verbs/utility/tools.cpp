// `ecs utility tools, tool`: the table of tools in the unit, which of them acts, and the wires to the control.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/tools.hpp"
#include "laser/csv_table.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::app {
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

Cell tool_cell(const Tool& tool) {
  return record_cell("{number:>6} {x_mm:>10} {y_mm:>10} {z_mm:>10}\n", "number"_is(tool.number),
                     "x_mm"_is(tool.offset_mm[0], 4), "y_mm"_is(tool.offset_mm[1], 4), "z_mm"_is(tool.offset_mm[2], 4));
}

Cell acting_cell(const protocol::ControlLines& lines) {
  std::string text =
      lines.tool == 0 ? "no tool of the table is selected" : fmt::format("tool {} is selected", lines.tool);
  if (lines.tool_state == protocol::ToolState::unknown)
    text += lines.tool == 0 ? ", but the table of tools was damaged: select the tool or send the table again"
                            : ", but it is not in the table, or is beyond compensation.tool_range_mm";
  if (!lines.compensating_out)
    text += "; the unit does not compensate now\n";
  else
    text += fmt::format("; acting offset X {:.4f}, Y {:.4f}, Z {:.4f} mm{}\n", lines.tool_offset_mm[0],
                        lines.tool_offset_mm[1], lines.tool_offset_mm[2],
                        lines.tool_state == protocol::ToolState::changing ? ", still changing" : "");
  return {lines.tool, text};
}

/// What acts, acts only while the unit compensates.
std::string_view state_text(const protocol::ControlLines& lines) {
  const bool selected = lines.tool_state == protocol::ToolState::acting && !lines.compensating_out;
  return selected ? "selected" : name_of(lines.tool_state);
}

std::string wires_text(const protocol::ControlLines& lines) {
  std::string text = lines.tool_wired ? "the control selects the tool by its wires\n" : "a host selects the tool\n";
  if (lines.control_on_wired) text += fmt::format("the control is {}\n", lines.control_on ? "on" : "off");
  return text;
}

Result<Outcome> show_tools(VerbContext& context, const cli::Nothing&) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(lines, unit.client().control_lines());
  ECS_TRY(table, unit.client().tool_table());
  const std::vector<Tool> tools = tools_of(table);
  const Cell battery = battery_cell(lines);
  return outcome_of(record_cell(
      "{selected}{tool_wired}{battery}{tools}", "selected"_is(acting_cell(lines)), "state"_is(state_text(lines)),
      "acting_mm"_is(Cell{
          Json{{"x", lines.tool_offset_mm[0]}, {"y", lines.tool_offset_mm[1]}, {"z", lines.tool_offset_mm[2]}}, {}}),
      "tool_wired"_is(lines.tool_wired, wires_text(lines)), "control_on_wired"_is(lines.control_on_wired),
      "control_on"_is(lines.control_on), "compensating_output"_is(lines.compensating_out),
      "fault_output"_is(lines.fault_out), "battery"_is(Cell{battery.json, fmt::format("battery {}\n", battery.text)}),
      "battery_age_s"_is(lines.battery_age_s),
      "tools"_is(tools.empty() ? Cell{Json::array(), "the table of tools is empty\n"}
                               : list_cell(tools, tool_cell, "number       x mm       y mm       z mm\n"))));
}

/// A table of the columns number, x_mm, y_mm, z_mm.
Result<std::vector<Tool>> tools_in(const std::string& file) {
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
      tools.push_back({static_cast<std::uint16_t>(*number), {*x, *y, *z}});
  }
  if (tools.empty() && findings.empty())
    findings.add(0, 0, "expected at least one tool; `ecs utility tool N --remove` removes one");
  if (tools.size() > kMostTools) findings.add(0, 0, "expected at most {} tools, found {}", kMostTools, tools.size());
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return tools;
}

struct SendToolsRequest {
  std::string file;
  static Fields<SendToolsRequest> fields() {
    using R = SendToolsRequest;
    return {{"FILE", &R::file, "table with the columns number, x_mm, y_mm, z_mm", Need::required}};
  }
};

/// Why the unit would refuse one of them, found out before anything is sent.
Result<void> check_tools(const std::string& file, const std::vector<Tool>& tools, const ToolTable& before,
                         const UnitParameters& parameters) {
  const Vector3& range_mm = parameters.tool_range_mm;
  for (const Tool& tool : tools)
    if (!in_range(tool.offset_mm, parameters))
      return problem(
          ProblemKind::refused,
          fmt::format("{}: tool {} is beyond the tool range of the unit's parameters, X {:.10g}, Y {:.10g}, Z "
                      "{:.10g} mm (compensation.tool_range_mm). The table in the unit is unchanged",
                      file, tool.number, range_mm[0], range_mm[1], range_mm[2]));
  if (before.selected != 0 && std::ranges::find(tools, before.selected, &Tool::number) == tools.end())
    return problem(ProblemKind::refused, fmt::format("{}: tool {} is selected, and is not in the file; select another "
                                                     "one first. The table in the unit is unchanged",
                                                     file, before.selected));
  return {};
}

/// What differs is sent, one tool after the other; what is not in the file is removed.
Result<Outcome> send_tools(VerbContext& context, const SendToolsRequest& request) {
  ECS_TRY(tools, tools_in(request.file));
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(before, unit.client().tool_table());
  ECS_TRY(parameters, receive_parameters(unit.client()));
  ECS_DO(check_tools(request.file, tools, before, parameters));
  std::size_t set = 0, removed = 0;
  for (const Tool& tool : tools_of(before)) {
    if (std::ranges::find(tools, tool.number, &Tool::number) != tools.end()) continue;
    ECS_DO(unit.client().remove_tool(tool.number));
    ++removed;
  }
  for (const Tool& tool : tools) {
    const Tool* const held = tool_of(before, tool.number);
    bool same = held != nullptr;
    for (std::size_t a = 0; a < kAxes && same; ++a)
      same = std::abs(held->offset_mm[a] - tool.offset_mm[a]) < 0.5 * protocol::kToolStep_mm;
    if (same) continue;
    ECS_DO(unit.client().set_tool(tool));
    ++set;
  }
  return outcome_of(record_cell("{tools} tools in the unit: {set} set, {removed} removed", "tools"_is(tools.size()),
                                "set"_is(set), "removed"_is(removed)));
}

struct ToolRequest {
  int number = 0;
  std::vector<double> offset_mm;
  bool remove = false;
  static Fields<ToolRequest> fields() {
    using R = ToolRequest;
    Fields<R> offset{cli::Argument{.name = "--offset",
                                   .into = {},
                                   .help = "put the tool with this offset X,Y,Z [mm] into the table instead",
                                   .by_commas = true},
                     [](R& r) -> cli::Argument::Target {
                       return cli::OnNumbers([&r](const std::vector<double>& mm) { r.offset_mm = mm; });
                     }};
    return {{"NUMBER", &R::number, "number of the tool; 0: none of the table", Need::required,
             cli::Range{0, kGreatestToolNumber}},
            offset,
            {"--remove", &R::remove, "remove the tool from the table instead"}};
  }
};

Result<Outcome> change_tool(VerbContext& context, const ToolRequest& request) {
  const auto number = static_cast<std::uint16_t>(request.number);
  if (request.remove && !request.offset_mm.empty()) return problem(ProblemKind::usage, "--remove excludes --offset");
  if (!request.offset_mm.empty() && request.offset_mm.size() != kAxes)
    return problem(ProblemKind::usage,
                   fmt::format("--offset: expected X,Y,Z in mm, got {} numbers", request.offset_mm.size()));
  ECS_TRY(unit, open_unit(context));
  const auto answer = [&](std::string_view what) {
    return outcome_of(record_cell("tool {tool} {done}", "tool"_is(number), "done"_is(what)));
  };
  if (request.remove) return unit.client().remove_tool(number).map([&] { return answer("removed"); });
  if (request.offset_mm.empty()) return unit.client().select_tool(number).map([&] { return answer("selected"); });
  const Tool tool{number, {request.offset_mm[0], request.offset_mm[1], request.offset_mm[2]}};
  return unit.client().set_tool(tool).map([&] { return answer("set"); });
}

}  // namespace

extern const std::vector<Action> kUtilityTools{
    action("utility tools", "show the table of tools in the unit, the tool that acts, and the wires to the control",
           "ecs utility tools", show_tools, {.link = Link::reads}),
    action("utility tool", "select a tool, also while the unit compensates; or set or remove one in the table",
           "ecs utility tool 3\n  ecs utility tool 3 --offset 0,0,152.4", change_tool, {.link = Link::writes}),
    action("utility send-tools", "make the table of tools in the unit equal to a file",
           "ecs utility send-tools tools.csv", send_tools, {.link = Link::writes})};

}  // namespace ecs::app
