#include "commissioning/maps/prepared_map.hpp"

#include "commissioning/maps/findings.hpp"
#include "commissioning/unit/map_checks.hpp"
#include "laser/map/csv.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

Result<PreparedMap> prepared_map(const std::string& map_file, const std::string& params_file,
                                 const PrepareOptions& options) {
  ECS_TRY(map, laser::read_map_csv(map_file));
  ECS_TRY(parameters, params::read_parameters(params_file));
  if (auto wrong = objections_to(parameters, params_file, options.incomplete)) return tl::unexpected(std::move(*wrong));
  std::vector<std::string> objections = objections_to_map(map, parameters.parameters);
  if (!options.other_machine)
    for (std::string& differs : other_machine(map.header, parameters.identity))
      objections.push_back(std::move(differs));
  if (auto refused = refused_map(objections, map_file)) return tl::unexpected(std::move(*refused));
  ECS_TRY(image, laser::image_of(map, parameters.parameters));
  if (!image.changed.empty() && !options.accept_resampling) {
    std::vector<std::string> why = image.changed;
    why.front() +=
        "; more than the resolution of the unit's memory: give the table evenly spaced points, or send it "
        "with --accept-resampling";
    return tl::unexpected(std::move(*refused_map(why, map_file)));
  }
  std::vector<std::string> remarks = remarks_in(findings_with_travels(map, parameters, params_file));
  for (std::string& taken : params::defaults_taken(parameters)) remarks.push_back(std::move(taken));
  return PreparedMap{map.header, parameters.identity, std::move(image), std::move(remarks)};
}

std::vector<std::string> other_unit(const PreparedMap& map, const std::string& serial_number) {
  std::vector<std::string> objections = other_unit(map.header, serial_number);
  for (std::string& differs : other_unit(map.identity, serial_number)) objections.push_back(std::move(differs));
  return objections;
}

}  // namespace ecs::commissioning
