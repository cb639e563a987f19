#include "commissioning/maps/build.hpp"

#include <algorithm>

#include "laser/map/csv.hpp"

namespace ecs::commissioning {

bool MadeMap::complete() const {
  return std::none_of(findings.begin(), findings.end(), [](const auto& finding) { return finding.objection; });
}

Result<MadeMap> made_map(const laser::MapRecipe& recipe, const params::ParametersFile& parameters,
                         const laser::Travels& travels, const laser::FileReader& read) {
  ECS_TRY(built, laser::build_map(recipe, parameters.parameters, read));
  laser::MapHeader& header = built.map.header;
  if (header.machine.empty()) header.machine = parameters.identity.machine;
  if (header.serial_number.empty()) header.serial_number = parameters.identity.serial_number;
  auto findings = laser::findings_for(built.map, built.parameters, travels);
  return MadeMap{std::move(built), std::move(findings)};
}

Result<MadeMap> opened_map(const std::string& file, const std::vector<laser::DeclaredZero>& zero,
                           const params::ParametersFile& parameters, const laser::Travels& travels) {
  ECS_TRY(map, laser::read_map_csv(file));
  map.header.declared_zero.insert(map.header.declared_zero.end(), zero.begin(), zero.end());
  auto findings = laser::findings_for(map, parameters.parameters, travels);
  return MadeMap{{std::move(map), parameters.parameters, {}, {}}, std::move(findings)};
}

}  // namespace ecs::commissioning
