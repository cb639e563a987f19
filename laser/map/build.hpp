// From measured files to the error map (thesis 5.3, PROCESS LASER DATA): each needed component from its own files,
// everything that was done kept in the header.
// Does not live here: the arithmetic on curves (laser/analysis/process.hpp), the recipe (recipe.hpp), the bytes
// (image.hpp).
#pragma once

#include <string>
#include <vector>

#include "laser/import/import.hpp"
#include "laser/map/error_map.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::laser {

/// What became of one component.
struct ComponentOutcome {
  Component component = Component::EXX;
  double band = 0.0;            ///< range of all readings used, as measured [um, um/m]
  double largest = 0.0;         ///< largest |compensation| in the tables; for squareness |value|
  double slope_um_per_m = 0.0;  ///< slope that was taken away
  double smoothed_rms = 0.0;    ///< rms of what smoothing took away; 0 without smoothing
  std::size_t readings = 0;
  std::size_t points = 0;  ///< per table
  std::vector<std::string> notes;
};

struct BuiltMap {
  ErrorMap map;
  UnitParameters parameters;  ///< as given, with the squareness values that were measured
  std::vector<ComponentOutcome> outcomes;
  std::vector<std::string> notes;
};

/// Builds the map that a recipe describes, for a unit with these parameters. Refuses, naming file and component:
/// a file without readings of that axis and sense (and says what it has), readings on more than one line, curves off
/// the measurement line of the parameters, readings taken with compensation active, fewer than two targets, files of
/// different machines or serial numbers, a component that the parameters do not use. What is merely missing is
/// not refused here: findings_for() lists it, and map send refuses it.
[[nodiscard]] Result<BuiltMap> build_map(const MapRecipe& recipe, const UnitParameters& parameters,
                                         const FileReader& read = read_plain);

}  // namespace ecs::laser
