// Starting values of user effects that a diagnosis tries: found by fitting each alone beside the model.
// Does not live here: the fit (model/fit/core.hpp), formulas (model/regression/user_formula.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "model/fit/model_file.hpp"
#include "model/regression/regressors.hpp"

namespace ecs::model {

/// The candidate with the `start` of its free parameters where the readings like them best, tried from several places
/// of their ranges; unchanged where nothing is to be fitted or the formulas do not compile.
[[nodiscard]] EffectInstance with_best_start(const Model& model, const EffectInstance& candidate,
                                             const Regressors& regressors);

/// Places in effect.user of the free parameters in which the formulas are no straight line; none of a library effect.
[[nodiscard]] std::vector<std::size_t> nonlinear_user_parameters(const EffectInstance& effect,
                                                                 const Observations& data);

}  // namespace ecs::model
