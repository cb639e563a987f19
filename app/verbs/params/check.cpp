// `ecs params check`: all findings against a parameter file.
#include "params/check.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/json.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct CheckArguments : VerbArguments {
  const std::string& file = text("FILE", "parameter file", Need::required);
  const std::string& machine = text("--machine", "machine file to compare with");
};

Json findings_json(const std::vector<params::Finding>& findings) {
  Json out = Json::array();
  for (const params::Finding& finding : findings)
    out.push_back(
        {{"severity", params::name_of(finding.severity)}, {"keys", finding.keys}, {"message", finding.message}});
  return out;
}

Result<Outcome> check_file(VerbContext& context, const CheckArguments& arguments) {
  const auto file = params::read_parameters(arguments.file);
  if (!file) return tl::unexpected(file.error());
  std::optional<params::Machine> machine;
  if (!arguments.machine.empty()) {
    auto read = params::read_machine(arguments.machine);
    if (!read) return tl::unexpected(read.error());
    for (const Problem& warning : read->warnings) context.console.warn(to_text(warning));
    machine = read->machine;
  }
  std::vector<params::Finding> findings = params::check_file(*file);
  for (params::Finding& finding : params::check(file->parameters, machine ? &*machine : nullptr))
    findings.push_back(std::move(finding));
  const bool sound = !params::has_errors(findings);
  Json object{{"file", arguments.file},
              {"sound", sound},
              {"findings", findings_json(findings)},
              {"defaulted", file->defaulted}};
  std::string text = params::to_text(findings);
  if (text.empty()) text = fmt::format("{}: sound", arguments.file);
  for (const std::string& taken : params::defaults_taken(*file)) text += "\n" + taken;
  return Outcome{text, one_line(object), findings.empty() ? kDone : kDoesNotHold};
}

}  // namespace

extern const VerbDefinition kParamsCheck =
    verb<CheckArguments>("params check", "every finding against a parameter file, with what to do",
                         "ecs params check mill.toml --machine machine.toml", check_file);

}  // namespace ecs::app
