#include "app/verbs/export/export_arguments.hpp"

#include "app/verbs/map/map_source.hpp"

namespace ecs::app {

void take_export_arguments(Verb& verb, ExportArguments& arguments, const std::string& output_help) {
  verb.text("FILE", arguments.map, "map CSV; or give --unit")
      .flag("--unit", arguments.unit, "the map in the unit, with its parameters")
      .text("--params", arguments.params, "parameters the map goes with: squareness, reference positions, lines")
      .text("--machine", arguments.machine, "machine file: the travels")
      .text("--model", arguments.model, "predict what is left from this model instead of from the map; needs --machine")
      .flag("--other-machine", arguments.other_machine, "export although map and parameters name different machines")
      .text("-o,--output", arguments.output, output_help)
      .flag("--force", arguments.force, "overwrites output files that are there")
      .uses_link();
}

Result<ExportWork> read_export_work(VerbContext& context, const ExportArguments& arguments) {
  if (!arguments.model.empty() && arguments.machine.empty())
    return problem(ProblemKind::usage, "--model needs --machine: the model counts from the datum of its axes");
  ECS_TRY(found, found_map(context, arguments.map, arguments.unit));
  return export_work(context.console, arguments, std::move(found));
}

}  // namespace ecs::app
