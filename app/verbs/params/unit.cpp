// `ecs params send, receive`: the parameters between file and unit.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/unit/map_checks.hpp"
#include "commissioning/unit/parameters_view.hpp"
#include "commissioning/unit/transfer.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct SendArguments : VerbArguments {
  const std::string& file = text("FILE", "parameter file", Need::required);
  const bool& force = flag("--force", "drop a map in the unit that does not fit, in place of refusing");
  const bool& other_machine = flag("--other-machine", "send although [identity] names another machine");
  const bool& accept_incomplete =
      flag("--accept-incomplete", "send although the parameter file does not end with its closing line");
  const Access access = writes_to_unit();
};

Outcome sent(const SendArguments& arguments, const SendReport& report, const params::ParametersFile& file) {
  return finished_outcome_of(record_cell(
      "parameters of {file} sent and verified: {bytes} bytes, commit {commit_sequence}{map_kept}{map_dropped}",
      {{"file", word_cell(arguments.file)},
       {"bytes", count_cell(report.bytes)},
       {"commit_sequence", count_cell(report.commit_sequence)},
       {"verified", yes_cell(true, "", "")},
       {"defaulted", lines_cell(file.defaulted, "")},
       {"map_kept", yes_cell(report.map_kept, "\nthe map in the unit fits and stays", "")},
       {"map_dropped", yes_cell(report.map_dropped, "\nthe unit has no map now: send one with `ecs map send`", "")},
       {"map_objections", lines_cell(report.map_objections, "")}}));
}

Result<Outcome> send(VerbContext& context, const SendArguments& arguments) {
  ECS_TRY(file, params::read_parameters(arguments.file));
  const Incomplete incomplete = arguments.accept_incomplete ? Incomplete::accept : Incomplete::refuse;
  if (auto objections = objections_to(file, arguments.file, incomplete)) return tl::unexpected(std::move(*objections));
  for (const std::string& taken : params::defaults_taken(file)) context.console.warn(taken);
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(identity, unit.client().identity());
  const params::Identity owner = arguments.other_machine ? params::Identity() : file.identity;
  if (auto refused = refused_map(other_unit(owner, identity.serial_number), arguments.file))
    return tl::unexpected(std::move(*refused));
  const auto report =
      send_parameters(unit.client(), file.parameters, owner, arguments.force ? UnfitMap::drop : UnfitMap::refuse,
                      progress_bar(context, "parameters"));
  if (!report) return tl::unexpected(report.error());
  for (const std::string& objection : report->map_objections)
    context.console.warn("the map in the unit is dropped: " + objection);
  return sent(arguments, *report, file);
}

struct ReceiveArguments : VerbArguments {
  const std::string& output = output_file("-o,--output", "file to write; without it the text goes to stdout");
  const Access access = uses_link();
};

Result<Outcome> receive(VerbContext& context, const ReceiveArguments& arguments) {
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(identity, unit.client().identity());
  ECS_TRY(parameters, receive_parameters(unit.client()));
  const params::Identity owner{{}, identity.serial_number};
  if (!arguments.output.empty()) ECS_DO(params::write_parameters(arguments.output, parameters, owner));
  return outcome_of(
      record_cell(arguments.output.empty() ? "{toml}" : "parameters of unit {serial_number} written to {file}",
                  {{"file", text_cell(arguments.output)},
                   {"serial_number", text_cell(identity.serial_number)},
                   {"parameters", parameters_cell(parameters)},
                   {"toml", shown_cell(params::parameters_toml(parameters, owner))}}));
}

}  // namespace

extern const VerbDefinition kParamsSend =
    verb<SendArguments>("params send", "check a parameter file and send it to the unit; its map stays",
                        "ecs params send mill-parameters.toml --link rtu:/dev/ttyUSB0:115200", send);

extern const VerbDefinition kParamsReceive =
    verb<ReceiveArguments>("params receive", "the unit's parameters as a file",
                           "ecs params receive -o from-unit.toml --link rtu:/dev/ttyUSB0:115200", receive);

}  // namespace ecs::app
