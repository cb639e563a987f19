// The error map that a model compiles to, what the unit cannot compensate, and what a unit expects of its curves:
// measured tool against workpiece, they hold the lever of the moving axis itself, which a model keeps apart.
// Does not live here: the terms (core/terms.hpp).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/map/error_map.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::model {

/// Positions of a table from one end of the travel to the other, the far end included [mm, machine coordinates].
/// @pre increment_mm > 0
[[nodiscard]] std::vector<double> table_positions(const params::MachineAxis& axis, double increment_mm);

/// The error map of a model, and what stays out of it.
struct CompiledModel {
  laser::ErrorMap map;
  std::vector<std::string> carried;
  std::map<std::string, double> largest;              ///< what an effect adds to its table at most, by name: um, um/m
  std::vector<std::string> not_carried;               ///< with the reason
  std::map<char, std::vector<std::string>> rotary{};  ///< effects of each rotary axis of the map
  ComponentValues squareness{};                       ///< C0Y, B0Z, A0Z for the unit's parameters, um/m
};
/// @param fitted  a model with values
[[nodiscard]] Result<CompiledModel> compiled(const Model& fitted, const params::Machine& machine, double increment_mm);

/// One rotation in the table of a translation.
struct OwnLever {
  Component table = Component::EXX;
  std::string effect;  ///< "angular:X:ECX"
};

/// Adds what rotations do through the coordinate of their own axis (ECX over X in EY of workpiece-side axes …) to the
/// tables of the translations, which are made where there are none; says so in the header and among `carried`.
/// @param fitted  the model that `compiled` was made from @param increment_mm  of tables to be made
std::vector<OwnLever> add_own_levers(CompiledModel& compiled, const Model& fitted, const params::Machine& machine,
                                     double increment_mm);

}  // namespace ecs::model
