// What a unit expects of its curves: measured tool against workpiece, they hold the lever of the moving axis itself.
// A model keeps that lever apart. Does not live here: compiling a model (compiled_model.hpp), the terms
// (core/terms.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/fit/compiled_model.hpp"
#include "params/machine.hpp"

namespace ecs::model {

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
