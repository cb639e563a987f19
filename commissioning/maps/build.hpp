// The map that a recipe makes for the parameters of a unit, judged: the work of `ecs map build`, of the screen PROCESS
// LASER DATA, of whoever else has a recipe.
// Does not live here: how a map is made (laser/map/build.hpp), maps of models (from_model.hpp).
#pragma once

#include <vector>

#include "laser/map/build.hpp"
#include "laser/map/error_map.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

struct MadeMap {
  laser::BuiltMap map;
  std::vector<laser::MapFinding> findings;
  /// Nothing is objected to.
  [[nodiscard]] bool complete() const;
};

/// As laser::build_map(); machine and serial number are those of the parameters where neither recipe nor files state
/// them. @param travels  that the map should cover
[[nodiscard]] Result<MadeMap> made_map(const laser::MapRecipe& recipe, const params::ParametersFile& parameters,
                                       const laser::Travels& travels,
                                       const laser::FileReader& read = laser::read_plain);

/// A map that is there already, with what was declared zero since.
[[nodiscard]] Result<MadeMap> opened_map(const std::string& file, const std::vector<laser::DeclaredZero>& zero,
                                         const params::ParametersFile& parameters, const laser::Travels& travels);

}  // namespace ecs::commissioning
