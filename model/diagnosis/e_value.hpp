// Evidence for an effect on readings that it was not fitted to. Internal to model/ (Eigen).
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

}  // namespace ecs::model
