// Effects that the user writes as formulas (model/regression/user_formula.hpp): anything of theirs is in the model
// file.
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition user() {
  return {
      .id = "user",
      .title = "Written by the user",
      .formula = "formulas and their parameters",
      .cause = "as the user says",
      .tells_apart = "as the user says",
      .check = "check the cause described by the formula",
      .headline = "{name}, a formula of the model file, {sizes}",
      .how = "only effects of the library compile into a map",
      .separated_by = separations::kFinerTargets,
      .traits = {.several_alike = true, .on_rotary_axes = true},
      .place = Place::formulas,
  };
}

}  // namespace ecs::model::effects
