#include "commissioning/maps/findings.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/file_watch.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {

laser::Travels travels_of(const params::Machine& machine) {
  laser::Travels travels{};
  for (const Axis axis : kAllAxes)
    if (const auto& known = machine.axes[index_of(axis)]) travels[index_of(axis)] = known->travel_mm;
  return travels;
}

laser::Travels travels_beside(const std::string& params_file, const params::ParametersFile& parameters) {
  const auto file = std::filesystem::path(params_file).parent_path() / "machine.toml";
  if (params_file.empty() || !is_there(file)) return {};
  const auto read = params::read_machine(file);
  if (!read) return {};
  const params::Machine& machine = read->machine;
  const std::string& owner = parameters.identity.machine;
  const bool same =
      machine.configuration == configuration_of(parameters.parameters) && (owner.empty() || owner == machine.name);
  return same ? travels_of(machine) : laser::Travels{};
}

std::vector<laser::MapFinding> findings_with_travels(const laser::ErrorMap& map,
                                                     const params::ParametersFile& parameters,
                                                     const std::string& params_file) {
  return laser::findings_for(map, parameters.parameters, travels_beside(params_file, parameters));
}

std::vector<std::string> remarks_in(const std::vector<laser::MapFinding>& findings) {
  std::vector<std::string> remarks;
  for (const laser::MapFinding& finding : findings)
    if (!finding.objection) remarks.push_back(finding.message);
  return remarks;
}

std::string remarks_counted(std::size_t remarks) {
  return fmt::format("{} remark{}", remarks, remarks == 1 ? "" : "s");
}

std::string completeness(const std::vector<laser::MapFinding>& findings) {
  if (std::any_of(findings.begin(), findings.end(), [](const auto& f) { return f.objection; })) return "not complete";
  return findings.empty() ? "complete" : "complete, " + remarks_counted(findings.size());
}

std::string verdict_text(const std::vector<laser::MapFinding>& findings, bool of_two_machines) {
  if (of_two_machines)
    return fmt::format("the map is {}, but `ecs map send` refuses it: map and parameters are of two machines\n",
                       completeness(findings));
  if (findings.empty()) return "nothing is missing: the map can be sent\n";
  if (remarks_in(findings).size() < findings.size())
    return "the map is not complete: `ecs map send` will refuse it until this is mended\n";
  return fmt::format("the map is {}: it can be sent, but read {} first\n", completeness(findings),
                     findings.size() == 1 ? "it" : "them");
}

Result<laser::DeclaredZero> declared_zero_in(const std::string& word) {
  const std::size_t sign = word.find('=');
  const auto component = component_of(trimmed(std::string_view(word).substr(0, sign)));
  const std::string reason = sign == std::string::npos ? "" : std::string(trimmed(word.substr(sign + 1)));
  if (!component || reason.empty())
    return problem(
        ProblemKind::usage,
        fmt::format("--zero: expected CODE=\"reason\", as in EBY=\"too small to measure\", got \"{}\"", word));
  return laser::DeclaredZero{*component, reason};
}

}  // namespace ecs::commissioning
