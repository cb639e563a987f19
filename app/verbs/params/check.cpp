// `ecs params check`: all findings against a parameter file.
#include "params/check.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct CheckArguments : VerbArguments {
  const std::string& file = text("FILE", "parameter file", Need::required);
  const std::string& machine = text("--machine", "machine file to compare with");
};

Cell findings_cell(const std::vector<params::Finding>& findings, const std::string& file) {
  Cell list = list_cell(findings, [](const params::Finding& finding) {
    return record_cell({}, {{"severity", word_cell(params::name_of(finding.severity))},
                            {"keys", lines_cell(finding.keys, "")},
                            {"message", word_cell(finding.message)}});
  });
  list.text = findings.empty() ? fmt::format("{}: sound", file) : params::to_text(findings);
  return list;
}

Result<Outcome> check_file(VerbContext& context, const CheckArguments& arguments) {
  ECS_TRY(file, params::read_parameters(arguments.file));
  std::optional<params::Machine> machine;
  if (!arguments.machine.empty()) {
    ECS_TRY(read, params::read_machine(arguments.machine));
    for (const Problem& warning : read.warnings) context.console.warn(to_text(warning));
    machine = read.machine;
  }
  std::vector<params::Finding> findings = params::check_file(file);
  for (params::Finding& finding : params::check(file.parameters, machine ? &*machine : nullptr))
    findings.push_back(std::move(finding));
  std::string taken;
  for (const std::string& line : params::defaults_taken(file)) taken += "\n" + line;
  return outcome_of(record_cell("{findings}{defaulted}", {{"file", word_cell(arguments.file)},
                                                          {"sound", yes_cell(!params::has_errors(findings), "", "")},
                                                          {"findings", findings_cell(findings, arguments.file)},
                                                          {"defaulted", {file.defaulted, taken}}}),
                    findings.empty() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kParamsCheck =
    verb<CheckArguments>("params check", "every finding against a parameter file, with what to do",
                         "ecs params check mill.toml --machine machine.toml", check_file);

}  // namespace ecs::app
