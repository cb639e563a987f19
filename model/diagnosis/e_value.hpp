// Evidence for an effect: on readings that it was not fitted to, and the chance that noise lets it gain as much as it
// does, small enough to hold among many machines. Internal to model/ (Eigen).
// Does not live here: the level from replicates (noise_level.hpp).
#pragma once

#include <optional>

#include <Eigen/Dense>

#include "model/fit/noise.hpp"
#include "model/fit/search.hpp"

namespace ecs::model {

/// What an effect is weighed against: columns and target of the model with every other named effect, not whitened.
struct Evidence {
  const Regressors& regressors;
  const NoiseModel& noise;
  const std::vector<bool>& left_out;
};

/// What the readings may be without the effect: white noise and turbulence of seconds, or a wander as well.
enum class NullHypothesis { noise, noise_or_wander };

/// e-value of an effect: mean over splits by runs and by targets of how much likelier it makes readings that it was not
/// fitted to than the best the model can do when fitted to these very readings, each with its own size of the noise.
/// At most 1/α of data sets without the effect exceed α on average over them (Markov). Nothing where no split shows the
/// effect on both sides.
/// Beside a wander the readings that the effect was fitted to are given, for the others depend on them.
/// @param columns,target  of the model without the effect  @param effect  its searched parameter is sought anew
[[nodiscard]] std::optional<double> e_value_of(const Evidence& on, const Eigen::MatrixXd& columns,
                                               const Eigen::VectorXd& target, const EffectInstance& effect,
                                               NullHypothesis null);

/// F test of the columns of an effect beside those of the model, for having been the best of so many tests: at most a
/// share p of data sets of noise alone has any test with a value of p or less (Bonferroni). Exact for Gaussian noise of
/// any size and of the shape given; of all shapes that the readings leave possible the one that speaks least for the
/// effect counts.
/// @param columns,target  of the model without the effect  @param effect  at a value that was fixed before the readings
/// @param tests  candidates, times values tried of this one, times its sets of columns
[[nodiscard]] double p_value_of(const Evidence& on, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                const Eigen::MatrixXd& effect, double tests);

}  // namespace ecs::model
