// `ecs params show, set, diff, new`: what works on parameter files; show and diff also look into a unit.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/parameters/set.hpp"
#include "commissioning/session/shell_word.hpp"
#include "commissioning/unit/parameters_view.hpp"
#include "commissioning/unit/transfer.hpp"
#include "params/check.hpp"
#include "params/fields.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kUnitWord = "unit";

Result<UnitParameters> parameters_in_unit(VerbContext& context) {
  ECS_TRY(unit, open_unit(context, Access::reads));
  return receive_parameters(unit.client());
}

Result<UnitParameters> parameters_from(VerbContext& context, const std::string& file_or_unit) {
  if (file_or_unit == kUnitWord) return parameters_in_unit(context);
  ECS_TRY(file, params::read_parameters(file_or_unit));
  return file.parameters;
}

// --- show
struct ShowArguments : VerbArguments {
  const std::string& file = text("FILE", "parameter file");
  const bool& unit = flag("--unit", "those in the unit");
  const Access access = uses_link();
};

Result<Outcome> show_unit(VerbContext& context) {
  ECS_TRY(parameters, parameters_in_unit(context));
  return outcome_of(record_cell("{parameters}", {{"parameters", parameters_cell(parameters)}}));
}

Result<Outcome> show(VerbContext& context, const ShowArguments& arguments) {
  if (arguments.unit == !arguments.file.empty())
    return problem(ProblemKind::usage, "params show: give either a FILE or --unit");
  if (arguments.unit) return show_unit(context);
  ECS_TRY(file, params::read_parameters(arguments.file));
  const auto& [machine, serial_number] = file.identity;
  const bool named = !machine.empty() || !serial_number.empty();
  const Cell identity = record_cell(named ? "machine {machine}, serial number {serial_number}\n\n" : "",
                                    {{"machine", text_cell(machine)}, {"serial_number", text_cell(serial_number)}});
  return outcome_of(record_cell("{identity}{parameters}", {{"file", word_cell(arguments.file)},
                                                           {"identity", identity},
                                                           {"parameters", parameters_cell(file.parameters)},
                                                           {"defaulted", {file.defaulted, {}}}}));
}

// --- set
struct SetArguments : VerbArguments {
  const std::string& file = text("FILE", "parameter file", Need::required);
  const std::vector<std::string>& words =
      texts("KEY=VALUE", "KEY=VALUE or KEY VALUE, as many as wanted; identity.machine and identity.serial_number too",
            Need::required);
  const std::string& output = output_file("-o,--output", "write here in place of FILE");
  const bool& accept_incomplete =
      flag("--accept-incomplete",
           "although FILE does not end with its closing line: what it leaves out is written "
           "as the default");
};

struct Assignment {
  std::string key;
  std::string value;
};

/// KEY=VALUE words and KEY VALUE pairs, mixed.
Result<std::vector<Assignment>> assignments_of(const std::vector<std::string>& words) {
  std::vector<Assignment> all;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    if (equals != std::string::npos) {
      all.push_back({words[i].substr(0, equals), words[i].substr(equals + 1)});
    } else if (i + 1 < words.size()) {
      all.push_back({words[i], words[i + 1]});
      ++i;
    } else {
      return problem(ProblemKind::usage, fmt::format("params set: expected a value after \"{}\"", words[i]));
    }
  }
  return all;
}

Cell changed_cell(const params::Difference& d) {
  return record_cell("{key}: {from} -> {to}{unit}\n", {{"key", word_cell(d.key)},
                                                       {"from", word_cell(d.a)},
                                                       {"to", word_cell(d.b)},
                                                       {"unit", shown_cell(d.unit.empty() ? "" : " " + d.unit)}});
}

void add_identity_change(Cell& changed, const char* key, const std::string& from, const std::string& to) {
  if (from != to) changed.add(changed_cell({key, "", from, to}));
}

Result<Outcome> set_values(VerbContext& context, const SetArguments& arguments) {
  ECS_TRY(file, arguments.accept_incomplete ? params::read_parameters(arguments.file)
                                            : params::read_whole_parameters(arguments.file));
  for (const std::string& taken : params::defaults_taken(file)) context.console.warn(taken);
  ECS_TRY(assignments, assignments_of(arguments.words));
  const UnitParameters before = file.parameters;
  const params::Identity owner_before = file.identity;
  commissioning::ParameterSet values{file.parameters, file.identity};
  std::vector<Problem> problems;
  for (const Assignment& assignment : assignments)
    if (auto set = commissioning::set_value(assignment.key, values, assignment.value); !set)
      problems.push_back(set.error());
  file.parameters = values.parameters;
  file.identity = values.identity;
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  for (const params::Finding& finding : params::check(file.parameters))
    context.console.warn(fmt::format("{}: {}", finding.keys.empty() ? "" : finding.keys.front(), finding.message));
  const std::string output = arguments.output.empty() ? arguments.file : arguments.output;
  ECS_DO(params::write_parameters(output, file.parameters, file.identity));
  Cell changed = list_cell(params::diff(before, file.parameters), changed_cell);
  add_identity_change(changed, "identity.machine", owner_before.machine, file.identity.machine);
  add_identity_change(changed, "identity.serial_number", owner_before.serial_number, file.identity.serial_number);
  if (changed.json.empty()) changed.text = "unchanged: these values stood there already\n";
  return outcome_of(record_cell("{changed}written to {file}", {{"file", word_cell(output)}, {"changed", changed}}));
}

// --- diff
struct DiffArguments : VerbArguments {
  const std::string& a = text("A", "parameter file, or `unit`", Need::required);
  const std::string& b = text("B", "parameter file, or `unit`", Need::required);
  const Access access = uses_link();
};

Result<Outcome> diff_two(VerbContext& context, const DiffArguments& arguments) {
  ECS_TRY(a, parameters_from(context, arguments.a));
  ECS_TRY(b, parameters_from(context, arguments.b));
  const auto differences = params::diff(a, b);
  Cell list = differences_cell(differences, "a", "b", arguments.a, arguments.b);
  if (differences.empty()) list.text = "no difference";
  return outcome_of(record_cell("{differences}", {{"a", word_cell(arguments.a)},
                                                  {"b", word_cell(arguments.b)},
                                                  {"same", yes_cell(differences.empty(), "", "")},
                                                  {"differences", list}}),
                    differences.empty() ? kDone : kDoesNotHold);
}

// --- new
struct NewArguments : VerbArguments {
  const std::string& machine = text("--machine", "machine file", Need::required);
  const std::string& output = output_file("-o,--output", "parameter file to write", Need::required);
};

Result<Outcome> new_file(VerbContext& context, const NewArguments& arguments) {
  ECS_TRY(machine, params::read_machine(arguments.machine));
  for (const Problem& warning : machine.warnings) context.console.warn(to_text(warning));
  const UnitParameters parameters = params::default_parameters_for(machine.machine);
  ECS_DO(params::write_parameters(arguments.output, parameters, {machine.machine.name, {}}));
  return outcome_of(record_cell(
      "{file}: parameters to start from; set the datum type, output scaling and polarity of the control, then "
      "`{check}`",
      {{"file", word_cell(arguments.output)},
       {"check", shown_cell(shell_command({"ecs", "params", "check", arguments.output}))},
       {"parameters", parameters_cell(parameters)}}));
}

}  // namespace

extern const VerbDefinition kParamsShow = verb<ShowArguments>("params show", "the parameters of a file or of the unit",
                                                              "ecs params show mill-parameters.toml", show);

extern const VerbDefinition kParamsSet = verb<SetArguments>(
    "params set", "change values in a parameter file",
    "ecs params set mill-parameters.toml axis.X.deadband_um=2.5 compensation.scope planar -o planar.toml", set_values);

extern const VerbDefinition kParamsDiff =
    verb<DiffArguments>("params diff", "what differs between two parameter sets; `unit` means the connected unit",
                        "ecs params diff mill-parameters.toml unit --link rtu:/dev/ttyUSB0:115200", diff_two);

extern const VerbDefinition kParamsNew =
    verb<NewArguments>("params new", "parameters to start from, for a machine file",
                       "ecs params new --machine machine.toml -o mill-parameters.toml", new_file);

}  // namespace ecs::app
