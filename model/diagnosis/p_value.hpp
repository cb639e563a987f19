// The chance that noise lets an effect gain as much as it does: small enough to hold among many machines. Internal to
// model/ (Eigen). Does not live here: evidence on readings that were not fitted to (e_value.hpp), the level from
// replicates (noise_level.hpp).
#pragma once

#include <Eigen/Dense>

#include "model/diagnosis/e_value.hpp"

namespace ecs::model {

/// F test of the columns of an effect beside those of the model, for having been the best of so many tests: at most a
/// share p of data sets of noise alone has any test with a value of p or less (Bonferroni). Exact for Gaussian noise of
/// any size and of the shape given; of all shapes that the readings leave possible the one that speaks least for the
/// effect counts.
/// @param columns,target  of the model without the effect  @param effect  at a value that was fixed before the readings
/// @param tests  candidates, times values tried of this one, times its sets of columns
[[nodiscard]] double p_value_of(const Evidence& on, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                const Eigen::MatrixXd& effect, double tests);

}  // namespace ecs::model
