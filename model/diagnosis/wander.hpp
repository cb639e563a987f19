// A slow wander of the measurement beside the effects found: turbulence over minutes, another zero in every pass, a
// random walk. Internal to model/ (Eigen). Does not live here: the noise that repeats show (model/fit/noise.hpp).
#pragma once

#include "model/fit/noise.hpp"

namespace ecs::model {

/// How well the readings agree with a model under one law of noise: −2 ln of the likelihood, the size of the noise at
/// its best, to be compared with others of the same readings; less is better.
/// @param columns  that the model may take freely (readings × columns)  @param target  readings less what it holds
[[nodiscard]] double deviance_of(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                 const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

/// A law of noise that wanders: the groups of `noise`, or beside them a level of its own for every run and sense.
struct Wander {
  NoiseModel noise;
  double level_um = 0.0;  ///< standard deviation of the levels of the runs
};
/// The likeliest of the wanders tried, and how well the readings agree with it, its price not included.
struct LikeliestWander {
  Wander law;
  double deviance = 0.0;
};
[[nodiscard]] LikeliestWander likeliest_wander(const Observations& data, const NoiseModel& noise,
                                               const std::vector<bool>& left_out, const Eigen::MatrixXd& columns,
                                               const Eigen::VectorXd& target);
[[nodiscard]] double deviance_of(const Observations& data, const Wander& law, const std::vector<bool>& left_out,
                                 const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

/// The deviance of the likeliest of them, Schwarz's price of its two parameters included.
[[nodiscard]] double deviance_of_wander(const Observations& data, const NoiseModel& noise,
                                        const std::vector<bool>& left_out, const Eigen::MatrixXd& columns,
                                        const Eigen::VectorXd& target);

/// Whether a wander can look like an effect in these readings: it changes in time or with a condition, or nothing
/// repeats it.
[[nodiscard]] bool may_be_wander(const NoiseModel& noise, const EffectInstance& effect);

}  // namespace ecs::model
