// `ecs map show` and `ecs map header`: a map from a file or from the unit, as text, JSON or plot.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/map/map_source.hpp"
#include "base/answer_table.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/view.hpp"
#include "commissioning/plot/curves.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct ShowArguments : VerbArguments {
  const std::string& file = text("FILE", "map CSV; or give --unit");
  const bool& unit = flag("--unit", "the map in the unit");
  const std::string& component = text("--component", "one of the 18 curves, with its values in --json");
  const std::string& params = text("--params", "parameters to judge the map by; with --unit the unit's own");
  const std::string& machine =
      text("--machine", "the machine (.toml): the travels to cover; by default machine.toml beside the parameters");
  const std::string& plot = output_file("--plot", "OUT.svg or OUT.png");
  const Access access = uses_link();
};

Result<std::optional<Component>> chosen(const std::string& name) {
  if (name.empty()) return std::optional<Component>();
  const auto component = component_of(name);
  if (!component || is_squareness(*component))
    return problem(ProblemKind::usage,
                   fmt::format("--component: expected one of the 18 curves, as in EXX, got \"{}\"{}", name,
                               component ? "; squareness is held in the parameters" : ""));
  return component;
}

using Judged = std::optional<std::vector<laser::MapFinding>>;

/// By --params, else by the parameters of the unit; nothing if neither. Travels: of --machine, else beside --params.
Result<Judged> judged(const ShowArguments& arguments, const FoundMap& found) {
  params::ParametersFile by;
  if (!arguments.params.empty()) {
    ECS_TRY(file, params::read_parameters(arguments.params));
    by = std::move(file);
  } else if (found.parameters) {
    by.parameters = *found.parameters;
  } else {
    return Judged();
  }
  if (arguments.machine.empty()) return Judged(findings_with_travels(found.map, by, arguments.params));
  ECS_TRY(machine, params::read_machine(arguments.machine));
  return Judged(laser::findings_for(found.map, by.parameters, travels_of(machine.machine)));
}

Cell judged_cell(const Judged& findings) {
  if (!findings) return null_cell("not checked: give --params for the objections to sending it\n");
  Cell cell = findings_cell(*findings);
  if (findings->empty()) cell.text = "no findings\n";
  return cell;
}

Result<Outcome> show(VerbContext& context, const ShowArguments& arguments) {
  ECS_TRY(only, chosen(arguments.component));
  if (!arguments.plot.empty()) ECS_DO(plot_format_of(arguments.plot));
  ECS_TRY(found, found_map(context, arguments.file, arguments.unit));
  ECS_TRY(findings, judged(arguments, found));
  std::vector<laser::MapTable> tables;
  for (const laser::MapTable& table : found.map.tables)
    if (!only || table.component == *only) tables.push_back(table);
  if (only && tables.empty())
    return problem(ProblemKind::refused, fmt::format("{} has no table of {}", found.name, name_of(*only)));
  if (!arguments.plot.empty()) {
    const std::string title = fmt::format("Error map of {}: compensation",
                                          found.map.header.machine.empty() ? found.name : found.map.header.machine);
    ECS_DO(write_plot(arguments.plot, figure_of(found.map, only, title)));
  }
  return outcome_of(
      record_cell("{header}\n{tables}{findings}{plot}", {{"map", word_cell(found.name)},
                                                         {"header", header_cell(found.map.header)},
                                                         {"tables", tables_cell(tables, only.has_value())},
                                                         {"findings", judged_cell(findings)},
                                                         {"plot", written_cell("plot", arguments.plot)}}));
}

struct HeaderArguments : VerbArguments {
  const std::string& file = text("FILE", "map CSV; or give --unit");
  const bool& unit = flag("--unit", "the map in the unit");
  const Access access = uses_link();
};

Result<Outcome> header(VerbContext& context, const HeaderArguments& arguments) {
  ECS_TRY(found, found_map(context, arguments.file, arguments.unit));
  const Cell header = header_cell(found.map.header);
  return outcome_of({object_of({{"map", word_cell(found.name)}, {{}, header}}), header.text});
}

}  // namespace

extern const VerbDefinition kMapShow =
    verb<ShowArguments>("map show", "header, tables and findings of a map file or of the map in the unit",
                        "ecs map show map.csv --params mill.toml --component EXX --plot exx.svg", show);

extern const VerbDefinition kMapHeader = verb<HeaderArguments>(
    "map header", "who made a map, when, for which machine, from which files and how", "ecs map header --unit", header);

}  // namespace ecs::app
