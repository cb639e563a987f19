// `ecs utility tools, tool`: the table of tools in the unit, which of them acts, and the wires to the control.
#include "core/tools.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/tools.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::app {
namespace {

Cell tool_cell(const Tool& tool) {
  return record_cell("{number:>6} {x_mm:>10} {y_mm:>10} {z_mm:>10}\n", "number"_is(tool.number),
                     "x_mm"_is(tool.offset_mm[0], 4), "y_mm"_is(tool.offset_mm[1], 4), "z_mm"_is(tool.offset_mm[2], 4));
}

std::string wires_text(const protocol::ControlLines& lines) {
  std::string text = lines.tool_wired ? "the control selects the tool by its wires\n" : "a host selects the tool\n";
  if (lines.control_on_wired) text += fmt::format("the control is {}\n", lines.control_on ? "on" : "off");
  return text;
}

Result<Outcome> show_tools(VerbContext& context, const cli::Nothing&) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(held, tools_in_unit(unit.client()));
  const protocol::ControlLines& lines = held.lines;
  const Cell battery = battery_cell(lines);
  return outcome_of(record_cell(
      "{selected}{tool_wired}{battery}{tools}", "selected"_is(lines.tool, acting_text(held) + "\n"),
      "damaged_copies"_is(held.damaged_copies), "state"_is(state_text(lines)),
      "acting_mm"_is(Cell{
          Json{{"x", lines.tool_offset_mm[0]}, {"y", lines.tool_offset_mm[1]}, {"z", lines.tool_offset_mm[2]}}, {}}),
      "tool_wired"_is(lines.tool_wired, wires_text(lines)), "control_on_wired"_is(lines.control_on_wired),
      "control_on"_is(lines.control_on), "compensating_output"_is(lines.compensating_out),
      "fault_output"_is(lines.fault_out), "battery"_is(Cell{battery.json, fmt::format("battery {}\n", battery.text)}),
      "battery_age_s"_is(lines.battery_age_s),
      "tools"_is(held.tools.empty() ? Cell{Json::array(), "the table of tools is empty\n"}
                                    : list_cell(held.tools, tool_cell, "number       x mm       y mm       z mm\n"))));
}

struct SendToolsRequest {
  std::string file;
  static Fields<SendToolsRequest> fields() {
    using R = SendToolsRequest;
    return {{"FILE", &R::file, "table with the columns number, x_mm, y_mm, z_mm", Need::required}};
  }
};

Result<Outcome> send_tools_of(VerbContext& context, const SendToolsRequest& request) {
  ECS_TRY(tools, read_tools(request.file));
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(sent, send_tools(unit.client(), request.file, tools));
  return outcome_of(record_cell("{tools} tools in the unit: {set} set, {removed} removed", "tools"_is(sent.tools),
                                "set"_is(sent.set), "removed"_is(sent.removed)));
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
    return {{"NUMBER", &R::number, "number of the tool; 0: no tool of the table", Need::required,
             cli::Range{0, kGreatestToolNumber}},
            offset,
            {"--remove", &R::remove, "remove the tool from the table instead"}};
  }
};

Result<Outcome> change_tool(VerbContext& context, const ToolRequest& request) {
  const auto number = static_cast<std::uint16_t>(request.number);
  if (request.remove && !request.offset_mm.empty()) return problem(ProblemKind::usage, "--remove excludes --offset");
  if (!request.offset_mm.empty() && request.offset_mm.size() != kAxes)
    return problem(ProblemKind::usage, "--offset: expected X,Y,Z in mm, got {} numbers", request.offset_mm.size());
  ECS_TRY(unit, open_unit(context));
  const auto answer = [&](std::string_view what) {
    return outcome_of(
        record_cell(number == 0 ? "no tool is selected from the tool table: the tool offset in the parameters applies"
                                : "tool {tool} {done}",
                    "tool"_is(number), "done"_is(what)));
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
           "ecs utility tool 3\n  ecs utility tool 3 --offset 0,0,-152.4", change_tool, {.link = Link::writes}),
    action("utility send-tools", "make the table of tools in the unit equal to a file",
           "ecs utility send-tools tools.csv", send_tools_of, {.link = Link::writes})};

}  // namespace ecs::app
