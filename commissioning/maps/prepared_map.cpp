#include "commissioning/maps/prepared_map.hpp"

#include "commissioning/maps/findings.hpp"
#include "commissioning/unit/map_checks.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/csv.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

Result<PreparedMap> prepared_map(const std::string& map_file, const std::string& params_file, bool other) {
  const auto map = laser::read_map_csv(map_file);
  if (!map) return tl::unexpected(map.error());
  const auto parameters = params::read_parameters(params_file);
  if (!parameters) return tl::unexpected(parameters.error());
  if (auto wrong = objections_to(parameters->parameters, params_file)) return tl::unexpected(std::move(*wrong));
  std::vector<std::string> objections = objections_to_map(*map, parameters->parameters);
  if (!other)
    for (std::string& differs : other_machine(map->header, parameters->identity))
      objections.push_back(std::move(differs));
  if (auto refused = refused_map(objections, map_file)) return tl::unexpected(std::move(*refused));
  auto image = laser::image_of(*map, parameters->parameters);
  if (!image) return tl::unexpected(image.error());
  std::vector<std::string> remarks = remarks_in(findings_with_travels(*map, *parameters, params_file));
  return PreparedMap{map->header, parameters->identity, std::move(*image), std::move(remarks)};
}

std::vector<std::string> other_unit(const PreparedMap& map, const std::string& serial_number) {
  std::vector<std::string> objections = other_unit(map.header, serial_number);
  for (std::string& differs : other_unit(map.identity, serial_number)) objections.push_back(std::move(differs));
  return objections;
}

}  // namespace ecs::commissioning
