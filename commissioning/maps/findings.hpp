// What the verbs, the screens and the report know of a map beside its tables: the travels that it should cover, how its
// findings are summed up in a word, a component declared zero with its reason.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/map/error_map.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

[[nodiscard]] laser::Travels travels_of(const params::Machine& machine);

/// The travels that the file `machine.toml` in the folder of a parameter file gives, if it describes the machine of
/// those parameters: the same chain and, where [identity] states one, the same name. Nothing known otherwise.
[[nodiscard]] laser::Travels travels_beside(const std::string& params_file, const params::ParametersFile& parameters);

/// Findings of a map and the parameters read from `params_file`, with the travels of travels_beside().
[[nodiscard]] std::vector<laser::MapFinding> findings_with_travels(const laser::ErrorMap& map,
                                                                   const params::ParametersFile& parameters,
                                                                   const std::string& params_file);

/// Messages of the findings that are no objections.
[[nodiscard]] std::vector<std::string> remarks_in(const std::vector<laser::MapFinding>& findings);

/// "1 remark", "2 remarks".
[[nodiscard]] std::string remarks_counted(std::size_t remarks);

/// "complete", "complete, 2 remarks", "not complete".
[[nodiscard]] std::string completeness(const std::vector<laser::MapFinding>& findings);

/// What a verb says below the findings of a map that it built.
/// @param of_two_machines  map and parameters name different ones
[[nodiscard]] std::string verdict_text(const std::vector<laser::MapFinding>& findings, bool of_two_machines = false);

/// A `usage` problem for anything but CODE=reason.
[[nodiscard]] Result<laser::DeclaredZero> declared_zero_in(const std::string& word);

}  // namespace ecs::commissioning
